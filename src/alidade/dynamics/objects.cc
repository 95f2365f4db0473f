#include "alidade/dynamics/objects.h"

#include <algorithm>
#include <optional>
#include <string>

#include "alidade/base/median.h"
#include "alidade/detect/class_names.h"
#include "alidade/detect/suppress.h"

namespace alidade {
namespace {

constexpr size_t kPast = FlowTracks::kHistory;

// Median motion over the last `ago` frames of the tracks for which `belongs` (called with their
// position then) holds; nullopt when they are fewer than `least`.
template <typename Belongs>
std::optional<cv::Point2f> MedianMotion(std::span<const FlowTrack> tracks, int ago, int least,
                                        Belongs&& belongs) {
  std::vector<float> x, y;
  for (const FlowTrack& track : tracks) {
    if (track.length() <= ago || !belongs(track.Before(ago))) continue;
    const cv::Point2f motion = track.at() - track.Before(ago);
    x.push_back(motion.x);
    y.push_back(motion.y);
  }
  if (x.size() < static_cast<size_t>(least)) return {};
  return cv::Point2f(UpperMedian(x), UpperMedian(y));
}

cv::Rect2f Inner(const cv::Rect2f& box, float share) {
  const cv::Size2f size(box.width * share, box.height * share);
  return {box.x + (box.width - size.width) / 2, box.y + (box.height - size.height) / 2, size.width,
          size.height};
}

}  // namespace

ObjectTracks::ObjectTracks(const DynamicsSettings& settings,
                           std::span<const std::string> class_names)
    : settings_(settings) {
  for (const std::string& name : class_names) {
    roles_.push_back(IsListed(settings.moving_classes, name)    ? Role::kMoving
                     : IsListed(settings.carried_classes, name) ? Role::kCarried
                                                                : Role::kNone);
  }
}

ObjectTracks::Role ObjectTracks::RoleOf(int class_id) const {
  return class_id >= 0 && class_id < static_cast<int>(roles_.size()) ? roles_[class_id]
                                                                     : Role::kNone;
}

void ObjectTracks::Advance(std::span<const FlowTrack> tracks, const Cells& cells, double time,
                           cv::Size image) {
  const ObjectSettings& limits = settings_.objects;
  const cv::Rect2f picture(0, 0, static_cast<float>(image.width), static_cast<float>(image.height));
  std::vector<MovingObject> kept;
  for (MovingObject& object : objects_) {
    const bool known = !object.cells.empty();
    const auto motion = MedianMotion(tracks, 1, limits.flow_tracks, [&](cv::Point2f p) {
      if (known)
        return std::binary_search(object.cells.begin(), object.cells.end(), cells.At(p.x, p.y));
      return Inner(object.box, limits.flow_middle).contains(p);
    });
    if (motion) object.velocity = *motion;
    object.past.push_front(object.box);
    if (object.past.size() > kPast) object.past.pop_back();
    if (settings_.propagate) object.box += object.velocity;
    if (time - object.seen > settings_.bridge_seconds || (object.box & picture).area() <= 0)
      continue;
    kept.push_back(std::move(object));
  }
  objects_ = std::move(kept);
}

void ObjectTracks::Update(std::span<const Detection> detections, int ago, double seen,
                          std::span<const FlowTrack> tracks) {
  const ObjectSettings& limits = settings_.objects;
  std::vector<uint8_t> taken(objects_.size(), 0);
  for (const Detection& detection : detections) {
    const Role role = RoleOf(detection.class_id);
    if (role == Role::kNone) continue;
    const auto then = [&](const MovingObject& object) {
      if (ago == 0 || object.past.empty()) return object.box;
      return object.past[std::min(static_cast<size_t>(ago), object.past.size()) - 1];
    };
    int best = -1;
    float most = limits.same_overlap;
    for (size_t i = 0; i < taken.size(); ++i) {
      const float overlap = Overlap(then(objects_[i]), detection.box);
      if (taken[i] || overlap <= most || objects_[i].carried != (role == Role::kCarried)) continue;
      most = overlap;
      best = static_cast<int>(i);
    }
    if (best >= 0) {
      MovingObject& object = objects_[best];
      taken[best] = 1;
      const cv::Rect2f old = then(object);
      const cv::Point2f moved = (object.box.tl() + object.box.br() - old.tl() - old.br()) / 2;
      object.box = settings_.propagate ? detection.box + moved : detection.box;
      object.class_id = detection.class_id;
      object.carried = role == Role::kCarried;
      object.seen = std::max(object.seen, seen);
      continue;
    }
    MovingObject object;
    object.id = next_id_++;
    object.class_id = detection.class_id;
    object.carried = role == Role::kCarried;
    object.box = detection.box;
    object.seen = seen;
    const cv::Rect2f inner = Inner(detection.box, limits.flow_middle);
    const auto motion = ago > 0 && settings_.propagate
                            ? MedianMotion(tracks, ago, limits.flow_tracks,
                                           [&](cv::Point2f p) { return inner.contains(p); })
                            : std::nullopt;
    if (motion) {
      object.velocity = *motion / static_cast<float>(ago);
      object.box += *motion;
    }
    objects_.push_back(std::move(object));
  }
}

void ObjectTracks::JudgeRest(std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                             const Cells& cells) {
  const ObjectSettings& limits = settings_.objects;
  for (MovingObject& object : objects_) {
    int moved = 0, rested = 0;
    for (size_t t = 0; t < tracks.size(); ++t) {
      const int cell = cells.At(tracks[t].at().x, tracks[t].at().y);
      if (!std::binary_search(object.cells.begin(), object.cells.end(), cell)) continue;
      moved += votes[t] < 0;
      rested += votes[t] > 0;
    }
    if (moved + rested < limits.rest_tracks) continue;
    if (moved > limits.moves_share * (moved + rested))
      object.static_log_odds += limits.moved;
    else if (rested > limits.rests_share * (moved + rested))
      object.static_log_odds += limits.rested;
    object.static_log_odds = std::clamp(object.static_log_odds, kObjectStatic, kRestingStatic);
  }
}

}  // namespace alidade
