#include "alidade/inertial/imu_stream.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "alidade/base/median.h"
#include "alidade/base/print.h"

namespace alidade {
namespace {

constexpr size_t kFirst = 200;                      // readings that decide about stamps and units
constexpr double kGap = 0.1;                        // seconds
constexpr double kSetBackBy = 1;                    // seconds
constexpr double kShortStep = 0.2;                  // of the mean step
constexpr double kBurstShare = 0.1;                 // of the steps
constexpr double kGain = 0.02, kPeriodGain = 1e-4;  // kGain² / 4: critically damped
// No sensor of a camera measures more: gyroscopes end at 70 rad/s, accelerometers at 32 g, some for
// crashes at 400 g.
constexpr double kMostRate = 1000, kMostForce = 1e4;
constexpr double kDeadFor = 3;                              // seconds
constexpr double kMovedRate = 0.5, kMovedForce = 1;         // rad/s, m/s²: not noise
constexpr double kSaturatedRate = 4, kSaturatedForce = 18;  // the smallest ranges: 250 deg/s, 2 g
constexpr int kSaturatedRun = 3;
// Median lengths of the specific force, m/s². A camera that is carried stays near 9.81.
constexpr double kNoGravity = 3, kMostGravity = 20;
// The same in g. Without gravity the length also comes near 0.
constexpr double kLeastG = 0.8, kMostG = 1.25;
// rad/s, of the fastest twentieth, and of the median: a hand turns a camera by 10 at most, and not
// for long.
constexpr double kFastRate = 20, kUsualRate = 3;

std::string Text(const char* form, double value) {
  char text[200];
  PrintTo(text, sizeof(text), form, value);
  return text;
}

bool Possible(const ImuSample& reading) {
  return std::isfinite(reading.time) && reading.angular_rate.allFinite() &&
         reading.specific_force.allFinite() && reading.angular_rate.norm() < kMostRate &&
         reading.specific_force.norm() < kMostForce;
}

bool Earlier(const ImuSample& a, const ImuSample& b) { return a.time < b.time; }

std::string SensorOf(int axis) { return axis < 3 ? "gyroscope" : "accelerometer"; }

}  // namespace

bool SeemInG(std::vector<double> forces) {
  if (forces.empty()) return false;
  const double median = UpperMedian(forces);
  const auto least = forces.begin() + static_cast<std::ptrdiff_t>(forces.size() / 20);
  std::nth_element(forces.begin(), least, forces.end());
  return median > kLeastG && median<kMostG&& * least> median / 2;
}

bool SeemInDegrees(std::vector<double> rates) {
  if (rates.empty()) return false;
  const auto fast = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() * 19 / 20);
  std::nth_element(rates.begin(), fast, rates.end());
  return *fast > kFastRate || UpperMedian(rates) > kUsualRate;
}

void EvenStamps::Restart() {
  running_ = false;
  first_.clear();
  last_ = -1e300;
}

void EvenStamps::Decide(const std::vector<double>& times) {
  std::vector<double> steps;
  double sum = 0;
  for (size_t i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    if (step > kGap) continue;
    steps.push_back(step);
    sum += step;
  }
  decided_ = true;
  if (steps.size() < kFirst / 2) return;
  period_ = sum / static_cast<double>(steps.size());
  const auto n = std::count_if(steps.begin(), steps.end(),
                               [&](double step) { return step < kShortStep * period_; });
  bursts_ = static_cast<double>(n) > kBurstShare * static_cast<double>(steps.size());
}

std::vector<double> EvenStamps::Add(std::vector<double> times) {
  if (!decided_) {
    first_.insert(first_.end(), times.begin(), times.end());
    if (first_.size() >= kFirst) {
      first_.resize(kFirst);
      Decide(first_);
      first_ = {};
    }
  }
  if (!bursts_) {
    if (!times.empty()) last_ = times.back();
    return times;
  }
  for (size_t i = 0; i < times.size(); ++i) {
    const double next = even_ + period_;
    if (!running_ || std::abs(times[i] - next) > kGap) {
      running_ = true;
      // Where the line through the next stamps begins: the first of a burst is not the mean.
      double sum = 0;
      size_t n = 0;
      for (; i + n < times.size() && n < kFirst / 4; ++n) {
        const double begin = times[i + n] - static_cast<double>(n) * period_;
        if (std::abs(begin - times[i]) > kGap) break;
        sum += begin;
      }
      even_ = sum / static_cast<double>(n);
    } else {
      const double error = times[i] - next;
      even_ = next + kGain * error;
      period_ += kPeriodGain * error;
    }
    even_ = std::max(even_, last_ + 0.1 * period_);
    times[i] = last_ = even_;
  }
  return times;
}

void ImuStream::Restart() {
  even_.Restart();
  any_ = false;
  for (Run& run : runs_) run.length = 0;
}

std::vector<ImuSample> ImuStream::Add(std::vector<ImuSample> readings) {
  const auto bad = std::remove_if(readings.begin(), readings.end(),
                                  [](const ImuSample& reading) { return !Possible(reading); });
  count_[kNotFinite] += readings.end() - bad;
  readings.erase(bad, readings.end());
  if (!std::is_sorted(readings.begin(), readings.end(), Earlier)) {
    ++count_[kUnordered];
    std::stable_sort(readings.begin(), readings.end(), Earlier);
  }
  if (any_ && !readings.empty() && readings.back().time < written_ - kSetBackBy) {
    ++count_[kSetBack];
    Restart();
  }
  std::vector<ImuSample> good;
  std::vector<double> times;
  for (const ImuSample& reading : readings) {
    if (any_ && reading.time <= written_) {
      ++count_[reading.time < written_ ? kLate : kRepeated];
      continue;
    }
    any_ = true;
    written_ = reading.time;
    good.push_back(reading);
    times.push_back(reading.time);
  }
  times = even_.Add(std::move(times));
  for (size_t i = 0; i < good.size(); ++i) {
    good[i].time = times[i];
    Watch(good[i]);
  }
  count_[kBursts] = even_.bursts() ? 1 : 0;
  return good;
}

void ImuStream::Watch(const ImuSample& reading) {
  const double step = reading.time - watched_;
  if (runs_[0].length > 0 && step > kGap) {
    ++count_[kGaps];
    longest_gap_ = std::max(longest_gap_, step);
  } else if (runs_[0].length > 0) {
    ++steps_;
    seconds_ += step;
  }
  watched_ = reading.time;
  WatchAxes(reading);
  if (judged_) return;
  rates_.push_back(reading.angular_rate.norm());
  forces_.push_back(reading.specific_force.norm());
  if (forces_.size() >= kFirst && seconds_ >= 1) JudgeUnits();
}

void ImuStream::WatchAxes(const ImuSample& reading) {
  Vector6d value;
  value << reading.angular_rate, reading.specific_force;
  for (int axis = 0; axis < 6; ++axis) {
    Run& run = runs_[static_cast<size_t>(axis)];
    if (run.length == 0 || run.value != value[axis]) {
      run = {value[axis], reading.time, 1, value, value};
    } else {
      ++run.length;
      run.low = run.low.cwiseMin(value);
      run.high = run.high.cwiseMax(value);
    }
    const double size = std::abs(value[axis]);
    most_[axis] = std::max(most_[axis], size);
    if (run.length >= kSaturatedRun && size == most_[axis] &&
        size > (axis < 3 ? kSaturatedRate : kSaturatedForce)) {
      count_[kSaturated] += run.length == kSaturatedRun ? kSaturatedRun : 1;
      saturated_axis_ = axis;
      saturated_at_ = size;
    }
    if (!broken_.empty() || reading.time - run.since < kDeadFor || run.length < 10) continue;
    const Vector6d range = run.high - run.low;
    const double rate = range.head<3>().maxCoeff(), force = range.tail<3>().maxCoeff();
    // The other sensor alone must move more: a camera can be shaken without turning.
    const bool moved = axis < 3 ? rate > kMovedRate || force > 4 * kMovedForce
                                : force > kMovedForce || rate > 2 * kMovedRate;
    if (!moved) continue;
    broken_ = "the " + SensorOf(axis) + "'s " + "xyz"[axis % 3] +
              Text(" axis is dead: it gives %g all the time, while the others move", run.value) +
              "; the inertial readings are not used";
  }
}

void ImuStream::JudgeUnits() {
  judged_ = true;
  const double force = UpperMedian(forces_);
  const bool in_g = SeemInG(forces_);
  const bool in_degrees = SeemInDegrees(rates_);
  const double rate = *std::max_element(rates_.begin(), rates_.end());
  forces_ = {};
  rates_ = {};
  if (!broken_.empty()) return;
  if (in_g) {
    broken_ = "the accelerations are in g, as it seems: give them in m/s²";
  } else if (force < kNoGravity) {
    broken_ = Text(
        "the accelerations lack gravity (their median length is %.2g m/s²): give those "
        "of the accelerometer itself",
        force);
  } else if (force > kMostGravity) {
    broken_ = Text("the accelerations cannot be m/s²: their median length is %.3g", force);
  } else if (in_degrees) {
    broken_ =
        Text("the angular rates are in deg/s, as it seems (up to %.3g): give them in rad/s", rate);
  }
  if (!broken_.empty()) broken_ += "; the inertial readings are not used";
}

double ImuStream::rate() const { return seconds_ > 0 ? static_cast<double>(steps_) / seconds_ : 0; }

std::string ImuStream::InWords(Kind kind) const {
  const long n = count_[kind];
  const std::string readings =
      std::to_string(n) + (n == 1 ? " inertial reading " : " inertial readings ");
  switch (kind) {
    case kNotFinite:
      return readings + "cannot be (not finite, or far beyond any sensor) and " +
             (n == 1 ? "is" : "are") + " left out";
    case kRepeated:
      return readings + (n == 1 ? "has" : "have") + " the time stamp of the one before and " +
             (n == 1 ? "is" : "are") + " left out";
    case kUnordered:
      return "the inertial readings are not in order of time; they are sorted";
    case kLate:
      return readings + "came too late and " + (n == 1 ? "is" : "are") + " left out";
    case kSetBack:
      return "the clock of the inertial readings was set back";
    case kGaps:
      return "the inertial readings have " + std::to_string(n) + (n == 1 ? " gap" : " gaps") +
             Text(n == 1 ? " of %.2g s" : " of up to %.2g s", longest_gap_);
    case kSaturated:
      return "the " + SensorOf(saturated_axis_) + Text(" is saturated at %.3g ", saturated_at_) +
             (saturated_axis_ < 3 ? "rad/s in " : "m/s² in ") + std::to_string(n) + " readings";
    case kBursts:
      return "the time stamps of the inertial readings come in bursts; they are spaced evenly";
    case kKinds:
      break;
  }
  return {};
}

std::vector<std::string> ImuStream::News() {
  std::vector<std::string> news;
  for (int i = 0; i < kKinds; ++i) {
    const auto kind = static_cast<size_t>(i);
    if (count_[kind] == 0 || told_[kind]) continue;
    told_[kind] = true;
    news.push_back(InWords(static_cast<Kind>(i)));
  }
  return news;
}

std::vector<ImuSample> OnOneClock(const std::vector<ImuSample>& gyroscope,
                                  const std::vector<ImuSample>& accelerometer) {
  std::vector<ImuSample> both;
  size_t after = 0;  // first acceleration not before the gyroscope's reading
  for (const ImuSample& turn : gyroscope) {
    while (after < accelerometer.size() && accelerometer[after].time < turn.time) ++after;
    if (after == accelerometer.size()) break;
    const ImuSample& b = accelerometer[after];
    if (b.time == turn.time) {
      both.push_back({turn.time, turn.angular_rate, b.specific_force});
      continue;
    }
    if (after == 0) continue;
    const ImuSample& a = accelerometer[after - 1];
    if (std::min(turn.time - a.time, b.time - turn.time) > kGap) continue;
    const double share = (turn.time - a.time) / (b.time - a.time);
    both.push_back(
        {turn.time, turn.angular_rate, (1 - share) * a.specific_force + share * b.specific_force});
  }
  return both;
}

}  // namespace alidade
