#include "alidade/run/export/map_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/text.h"
#include "alidade/run/world/moved_map.h"

namespace alidade {
namespace {

constexpr double kNear = 0.1;  // seconds between a named time and its frame
constexpr char kLandmark[] = "landmark:";

[[noreturn]] void Refuse(const std::string& place, const std::string& why) {
  ThrowUsage("--scale-by: '" + place + "' " + why);
}

class Places {
 public:
  Places(const SavedMap& saved, const MapPart& part, const Trajectory& trajectory)
      : saved_(saved), part_(part), trajectory_(trajectory) {}

  Eigen::Vector3d At(const std::string& place) const {
    if (place.rfind(kLandmark, 0) == 0) return LandmarkAt(place);
    if (place.find(',') != std::string::npos) return PointOf(place);
    const auto time = ParseNumber(place);
    if (!time) Refuse(place, "is neither a time in seconds, nor landmark:ID, nor x,y,z");
    return FrameAt(place, *time);
  }

 private:
  Eigen::Vector3d LandmarkAt(const std::string& place) const {
    const auto number = ParseNumber(place.substr(sizeof kLandmark - 1));
    const auto found = std::find_if(part_.landmarks.begin(), part_.landmarks.end(),
                                    [&](LandmarkId id) { return number && id.value == *number; });
    if (found == part_.landmarks.end()) Refuse(place, "is not in the map");
    return saved_.map.Find(*found)->p_world;
  }

  Eigen::Vector3d PointOf(const std::string& place) const {
    std::vector<double> numbers;
    for (size_t begin = 0; begin <= place.size();) {
      const size_t end = std::min(place.find(',', begin), place.size());
      const auto number = ParseNumber(std::string_view(place).substr(begin, end - begin));
      if (!number || !std::isfinite(*number)) Refuse(place, "is not a point x,y,z");
      numbers.push_back(*number);
      begin = end + 1;
    }
    if (numbers.size() != 3) Refuse(place, "is not a point x,y,z");
    return {numbers[0], numbers[1], numbers[2]};
  }

  Eigen::Vector3d FrameAt(const std::string& place, double time) const {
    double best = INFINITY;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    const auto offer = [&](double other, const Eigen::Vector3d& at) {
      if (!(std::abs(other - time) < best)) return;
      best = std::abs(other - time);
      center = at;
    };
    for (KeyFrameId id : part_.keyframes) {
      const KeyFrame& keyframe = *saved_.map.Find(id);
      offer(keyframe.frame->time, keyframe.Centre());
    }
    for (const StampedPose& pose : trajectory_) offer(pose.time, pose.T_world_camera.t);
    if (!(best <= kNear)) Refuse(place, "s: no frame within 0.1 s has a pose (see trajectory.txt)");
    return center;
  }

  const SavedMap& saved_;
  const MapPart& part_;
  const Trajectory& trajectory_;
};

}  // namespace

KnownDistance KnownDistanceOf(const std::vector<std::string>& words) {
  const auto meters = ParseNumber(words[2]);
  if (!meters) ThrowUsage("--scale-by: '" + words[2] + "' is not a number of meters");
  return {words[0], words[1], *meters};
}

double MetersPerUnit(const SavedMap& saved, const MapPart& part, const Trajectory& trajectory,
                     const KnownDistance& known) {
  if (saved.sensor != "mono") ThrowUsage("--scale-by: this map is in meters already");
  if (!(known.meters > 0) || !std::isfinite(known.meters))
    ThrowUsage("--scale-by: the distance must be a positive number of meters");
  const Places places(saved, part, trajectory);
  const double units = (places.At(known.a) - places.At(known.b)).norm();
  if (!(units > 0)) ThrowUsage("--scale-by: both places are the same");
  return known.meters / units;
}

void ScaleMap(SavedMap& saved, const MapPart& part, double factor) {
  Sim3 scaling;
  scaling.s = factor;
  MapWorld known;
  known.meters = true;
  MoveMap(saved, part, scaling, known);
}

}  // namespace alidade
