// Readings of an inertial sensor as they come from drivers and files, made fit for use: in order of
// time, finite, evenly stamped; and what was odd about them, in words.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/inertial/imu.h"

namespace ALIDADE_API alidade {

// Units by size, of the lengths of many readings: forces whose median is near 1 and that never come
// near 0 are in g; rates of which a twentieth exceeds 20, or half exceed 3, are in deg/s.
bool SeemInG(std::vector<double> forces);
bool SeemInDegrees(std::vector<double> rates);

// Replaces stamps that are times of arrival (several at once, then none for 35 ms) by evenly spaced
// ones. Stamps are left alone unless a tenth of the first 200 steps is shorter than a fifth of the
// mean step. Then each stamp is the one before plus the period, corrected by 2 % of the difference
// to the stamp as written, and the period by 0.01 % of it (a critically damped loop of second
// order). The mean delay remains; it is part of ImuModel::time_offset.
class EvenStamps {
 public:
  // `times`: strictly increasing, later than those of the call before. Returns as many, strictly
  // increasing.
  std::vector<double> Add(std::vector<double> times);
  void Restart();  // the next stamp need not continue the last one
  bool bursts() const { return bursts_; }

 private:
  void Decide(const std::vector<double>& times);

  std::vector<double> first_;  // stamps until the decision
  bool decided_ = false, bursts_ = false, running_ = false;
  double period_ = 0, even_ = 0, last_ = -1e300;  // seconds; even_, last_: the last one returned
};

// One instance per sensor. Memory is bounded.
class ImuStream {
 public:
  // Takes the next readings, in the order they came, and returns the good ones in order of time:
  // later than all returned before. Disorder within `readings` is sorted; what comes later than
  // that, repeats a stamp or is not finite is left out. A step back by more than a second is a
  // clock that was set back: readings continue there.
  std::vector<ImuSample> Add(std::vector<ImuSample> readings);
  // The next readings may be of another clock.
  void Restart();

  // Why the readings must not be used, as a sentence: an axis that is dead (the same value for 3 s
  // while the others move), no gravity in the accelerations, units other than m/s² and rad/s.
  // Empty: nothing found so far. It stays once it is set.
  const std::string& broken() const { return broken_; }
  // What was odd and could be dealt with, as sentences: each kind is told once, with the numbers at
  // the time of the call.
  std::vector<std::string> News();
  double rate() const;  // readings per second so far, without gaps; 0: unknown

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;  // angular rate, specific force
  // How long an axis has given one value, and what the readings did meanwhile.
  struct Run {
    double value = 0, since = 0;
    int length = 0;
    Vector6d low = Vector6d::Zero(), high = Vector6d::Zero();
  };
  enum Kind {
    kNotFinite,
    kRepeated,
    kUnordered,
    kLate,
    kSetBack,
    kGaps,
    kSaturated,
    kBursts,
    kKinds
  };

  void Watch(const ImuSample& reading);
  void WatchAxes(const ImuSample& reading);
  void JudgeUnits();
  std::string InWords(Kind kind) const;

  EvenStamps even_;
  bool any_ = false;
  double written_ = 0;                // the last stamp as written
  std::array<long, kKinds> count_{};  // of each kind
  std::array<bool, kKinds> told_{};
  std::array<Run, 6> runs_;
  Vector6d most_ = Vector6d::Zero();  // largest absolute values
  int saturated_axis_ = 0;
  double saturated_at_ = 0, longest_gap_ = 0;
  std::vector<double> rates_, forces_;  // lengths of the first readings
  bool judged_ = false;
  double watched_ = 0;  // time of the last reading watched
  long steps_ = 0;
  double seconds_ = 0;  // of steps that are no gaps
  std::string broken_;
};

// Readings of a gyroscope and an accelerometer that are stamped apart (the other half of each is
// ignored): the accelerations are interpolated at the times of the gyroscope. Both in order of
// time. Where the nearest acceleration is more than 0.1 s away, there is none.
std::vector<ImuSample> OnOneClock(const std::vector<ImuSample>& gyroscope,
                                  const std::vector<ImuSample>& accelerometer);

}  // namespace alidade
