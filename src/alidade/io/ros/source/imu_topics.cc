#include "alidade/io/ros/source/imu_topics.h"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/inertial/imu_stream.h"
#include "alidade/io/files/imu_file.h"
#include "alidade/io/ros/messages/messages.h"
#include "alidade/io/ros/source/static_frames.h"

namespace alidade {
namespace {

constexpr size_t kLookedAt = 50;  // messages that tell what a topic holds
constexpr double kStandardGravity = 9.80665;

struct Candidate {
  size_t topic = 0;
  std::string name, frame_id;
  bool rate = false, force = false;  // which quantities it holds
  size_t alike = 0;                  // letters its name shares with the images'
};

RosImu ReadImu(BagFile& bag, size_t topic, const BagMessage& message) {
  std::string bytes;
  if (const std::string problem = bag.Read(message, bytes); !problem.empty()) ThrowInput(problem);
  return ParseRosImu(bytes, bag.Topics()[topic].serialization);
}

// Drivers that publish one quantity leave the other one 0, or say so by a covariance of -1.
std::optional<Candidate> Look(BagFile& bag, size_t topic, const std::string& image) {
  Candidate candidate;
  candidate.topic = topic;
  candidate.name = bag.Topics()[topic].name;
  const auto& messages = bag.Messages(topic);
  bool any = false;
  for (size_t i = 0; i < std::min(messages.size(), kLookedAt); ++i) {
    try {
      const RosImu imu = ReadImu(bag, topic, messages[i]);
      any = true;
      candidate.frame_id = imu.header.frame_id;
      candidate.rate = candidate.rate || (imu.has_rate && !imu.angular_velocity.isZero(0));
      candidate.force = candidate.force || (imu.has_force && !imu.linear_acceleration.isZero(0));
    } catch (const Error&) {  // counted when all are read
    }
  }
  if (!any) return std::nullopt;
  const std::string& name = candidate.name;
  candidate.alike = static_cast<size_t>(
      std::mismatch(name.begin(), name.end(), image.begin(), image.end()).first - name.begin());
  return candidate;
}

// In order of time, finite, without repeated stamps.
std::vector<ImuSample> ReadAll(BagFile& bag, size_t topic) {
  std::vector<ImuSample> samples;
  size_t bad = 0;
  for (const BagMessage& message : bag.Messages(topic)) {
    try {
      const RosImu imu = ReadImu(bag, topic, message);
      const int64_t stamp = imu.header.stamp != 0 ? imu.header.stamp : message.log_time;
      samples.push_back(
          {1e-9 * static_cast<double>(stamp), imu.angular_velocity, imu.linear_acceleration});
    } catch (const Error&) {
      ++bad;
    }
  }
  if (bad > 0) {
    LogWarning(bag.Topics()[topic].name + ": " + std::to_string(bad) +
               (bad == 1 ? " message" : " messages") + " cannot be read");
  }
  return samples;
}

std::vector<ImuSample> InOrder(std::vector<ImuSample> samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const ImuSample& a, const ImuSample& b) { return a.time < b.time; });
  samples.erase(
      std::unique(samples.begin(), samples.end(),
                  [](const ImuSample& a, const ImuSample& b) { return a.time == b.time; }),
      samples.end());
  std::vector<double> times;
  for (const ImuSample& sample : samples) times.push_back(sample.time);
  times = EvenStamps().Add(std::move(times));
  for (size_t i = 0; i < samples.size(); ++i) samples[i].time = times[i];
  return samples;
}

// REP 145 asks for m/s² and rad/s; some drivers know better.
ImuUnits UnitsOf(const std::vector<ImuSample>& samples, const std::string& name) {
  std::vector<double> rates, forces;
  for (const ImuSample& sample : samples) {
    rates.push_back(sample.angular_rate.norm());
    forces.push_back(sample.specific_force.norm());
  }
  ImuUnits units;
  if (SeemInDegrees(std::move(rates))) {
    LogWarning(name + ": the angular rates are read as deg/s");
    units.rate = std::numbers::pi / 180;
  }
  if (SeemInG(std::move(forces))) {
    LogWarning(name + ": the accelerations are read as g");
    units.force = kStandardGravity;
  }
  return units;
}

std::vector<Candidate> CandidatesOf(BagFile& bag, const BagQuery& query, const std::string& image) {
  std::vector<std::string> named;
  if (query.imu) {
    const size_t comma = query.imu->find(',');
    named.push_back(query.imu->substr(0, comma));
    if (comma != std::string::npos) named.push_back(query.imu->substr(comma + 1));
  }
  std::vector<Candidate> candidates;
  std::string all;
  std::vector<bool> found(named.size());
  for (size_t topic = 0; topic < bag.Topics().size(); ++topic) {
    const BagTopic& about = bag.Topics()[topic];
    if (about.type != kImuType || bag.Messages(topic).empty()) continue;
    all += (all.empty() ? "" : ", ") + about.name;
    const auto at = std::find(named.begin(), named.end(), about.name);
    if (query.imu && at == named.end()) continue;
    if (query.imu) found[static_cast<size_t>(at - named.begin())] = true;
    if (const auto candidate = Look(bag, topic, image)) candidates.push_back(*candidate);
  }
  for (size_t i = 0; i < named.size(); ++i) {
    if (found[i]) continue;
    ThrowUsage("imu=" + named[i] + ": there is no such topic with sensor_msgs/Imu in " +
               query.path + "; there are " + (all.empty() ? "none" : all));
  }
  return candidates;
}

// The best one that holds these quantities; null: none.
const Candidate* Best(const std::vector<Candidate>& candidates, bool rate, bool force,
                      BagFile& bag) {
  const Candidate* best = nullptr;
  const auto rank = [&](const Candidate& candidate) {
    return std::pair(candidate.alike, bag.Messages(candidate.topic).size());
  };
  for (const Candidate& candidate : candidates) {
    if ((rate && !candidate.rate) || (force && !candidate.force)) continue;
    if (!best || rank(candidate) > rank(*best)) best = &candidate;
  }
  return best;
}

std::string PerSecond(const ImuRecording& imu) {
  char text[32];
  PrintTo(text, sizeof(text), " (%.0f Hz)", imu.model.rate);
  return text;
}

}  // namespace

BagImu ReadBagImu(BagFile& bag, const BagQuery& query, const PictureTopic& image) {
  if (query.imu && query.imu->empty()) return {};
  const std::vector<Candidate> candidates = CandidatesOf(bag, query, image.name);
  const Candidate* both = Best(candidates, true, true, bag);
  const Candidate* turns = both ? both : Best(candidates, true, false, bag);
  const Candidate* forces = both ? both : Best(candidates, false, true, bag);
  if (!turns || !forces) {
    if (!turns && !forces) return {};
    const std::string name = (turns ? turns : forces)->name;
    BagImu none;
    none.told = name + " is not used: there is no " + (turns ? "accelerometer" : "gyroscope") +
                " beside it";
    return none;
  }
  ImuRecording imu;
  std::string name = turns->name;
  if (both) {
    imu.samples = ReadAll(bag, both->topic);
  } else {
    name += " and " + forces->name;
    imu.samples =
        OnOneClock(InOrder(ReadAll(bag, turns->topic)), InOrder(ReadAll(bag, forces->topic)));
  }
  BagImu result;
  result.rate_topic = static_cast<int>(turns->topic);
  result.force_topic = static_cast<int>(forces->topic);
  result.units = UnitsOf(imu.samples, name);
  for (ImuSample& sample : imu.samples) {
    sample.angular_rate *= result.units.rate;
    sample.specific_force *= result.units.force;
  }
  if (const auto T = StaticTransform(bag, image.frame_id, turns->frame_id)) {
    imu.model.T_camera_imu = *T;
    imu.model.rotation_known = imu.model.translation_known = true;
  }
  const bool placed = imu.model.rotation_known;
  result.recording = CleanImu(std::move(imu), name);
  if (result.recording) {
    result.told = "inertial readings " + name + PerSecond(*result.recording) +
                  (placed ? ", placed by /tf_static" : ", their place is estimated");
  }
  return result;
}

}  // namespace alidade
