// Puts the messages of topics together to frames: the newest image, its partner and the inertial
// readings up to it.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "alidade/inertial/imu.h"

namespace alidade {

struct StampedBytes {
  int64_t stamp = 0;  // nanoseconds
  std::string bytes;  // the message
};

struct GatheredFrame {
  StampedBytes image;
  std::optional<StampedBytes> partner;  // depth or right image
  std::vector<ImuSample> imu;           // since the last frame
};

class FrameGatherer {
 public:
  // `max_dt`: largest time difference of an image and its partner, seconds; nullopt: no partners.
  // `with_imu`: images wait for readings up to their time.
  FrameGatherer(std::optional<double> max_dt, bool with_imu);

  void AddImage(StampedBytes image, double now);  // `now`: seconds of any steady clock
  void AddPartner(StampedBytes partner);
  void AddImu(const ImuSample& sample);

  // The newest image that is complete; older ones are dropped. An image that has waited for
  // kLongestWait goes without what has not come.
  std::optional<GatheredFrame> Take(double now);

  // A partner or a reading comes within this time of its image, or not at all, seconds.
  static constexpr double kLongestWait = 0.1;

 private:
  struct Waiting {
    StampedBytes image;
    double since = 0;
  };
  // Index of the partner nearest in time; -1: none within max_dt.
  int PartnerOf(const StampedBytes& image) const;
  bool HasReadings(const StampedBytes& image) const;

  std::optional<double> max_dt_;
  bool with_imu_;
  std::deque<Waiting> images_;
  std::deque<StampedBytes> partners_;
  std::vector<ImuSample> imu_;
};

}  // namespace alidade
