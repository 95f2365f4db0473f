#include "alidade/semidense/semidense_mapper.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "alidade/base/log.h"
#include "alidade/map/view.h"
#include "alidade/semidense/cross_check.h"
#include "alidade/semidense/keyframe_depth.h"
#include "alidade/semidense/landmark_agreement.h"
#include "alidade/semidense/packed_depth.h"
#include "alidade/semidense/partners.h"
#include "alidade/semidense/sensor_depth.h"

namespace alidade {

// State of one keyframe.
struct SemiDenseMapper::Entry {
  KeyFrameId id;
  GradientImage image;
  std::vector<Hypothesis> sensor;  // measured depth, one per edge; empty: not requested
  bool estimated = false;
  bool of_other_camera = false;  // processed with a previous camera model: to be redone
  PackedDepth depth;             // before the check between keyframes; one per edge
  double scale = 1;              // KeyFrame::scale at the time of estimation
  struct Partner {
    KeyFrameId id;
    Se3 T_partner_keyframe;  // at the time of estimation
  };
  std::vector<Partner> partners;  // used for the estimate
};

SemiDenseMapper::SemiDenseMapper(MapStore& map, const Camera& camera,
                                 const SemiDenseSettings& settings)
    : map_(map),
      camera_(camera),
      settings_(settings),
      maker_(camera, settings.min_gradient, settings.gradient_weight) {
  settings_.Check();
}

SemiDenseMapper::~SemiDenseMapper() = default;

void SemiDenseMapper::SetCamera(const Camera& camera) {
  const GradientImageMaker again(camera_, camera, settings_.min_gradient,
                                 settings_.gradient_weight);
  maker_ = GradientImageMaker(camera, settings_.min_gradient, settings_.gradient_weight);
  for (const auto& entry : entries_) {
    if (camera_.HasDistortion() || camera.HasDistortion())
      entry->image = again.Make(entry->image.Straight());
    entry->of_other_camera = entry->estimated;
    entry->depth = PackedDepth(std::vector<Hypothesis>(entry->image.edges.size()));
  }
  camera_ = camera;
}

void SemiDenseMapper::Keep(KeyFrameId id, std::shared_ptr<const Picture> picture) {
  const MapSnapshot map = map_.Snapshot();
  std::lock_guard<std::mutex> lock(inbox_mutex_);
  // Maps given up during initialization are never processed.
  std::erase_if(inbox_, [&](const auto& kept) { return !map.Find(kept.first); });
  inbox_.push_back({id, std::move(picture)});
  if (static_cast<int>(inbox_.size()) > settings_.max_waiting) {
    inbox_.erase(inbox_.begin());
    ++turned_away_;
  }
}

MapSnapshot SemiDenseMapper::TakeIn() {
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const Picture>>> arrived;
  int turned_away = 0;
  {
    std::lock_guard<std::mutex> lock(inbox_mutex_);
    arrived.swap(inbox_);
    turned_away = std::exchange(turned_away_, 0);
  }
  const MapSnapshot map = map_.Snapshot();
  std::erase_if(entries_, [&](const auto& entry) { return !map.Find(entry->id); });
  for (const auto& [id, picture] : arrived) {
    if (!map.Find(id)) continue;
    auto entry = std::make_unique<Entry>();
    entry->id = id;
    entry->image = maker_.Make(*picture);
    if (settings_.from_sensor) {
      entry->sensor = DepthFromSensor(picture->depth, entry->image.edges, camera_);
    }
    entries_.push_back(std::move(entry));
  }
  std::sort(entries_.begin(), entries_.end(),
            [](const auto& a, const auto& b) { return a->id < b->id; });
  LetGo(turned_away);
  return map;
}

void SemiDenseMapper::LetGo(int turned_away) {
  int waiting = 0;
  for (const auto& entry : entries_) waiting += !entry->estimated;
  const int before = report_.let_go;
  report_.let_go += turned_away;
  std::erase_if(entries_, [&](const auto& entry) {
    if (entry->estimated || waiting <= settings_.max_waiting) return false;
    --waiting;
    ++report_.let_go;
    return true;
  });
  if (before == 0 && report_.let_go > 0) {
    LogWarning("semi-dense mapping cannot keep up: more than " +
               std::to_string(settings_.max_waiting) +
               " keyframes are waiting (semidense.max_waiting), so the oldest ones get no depth");
  }
}

SemiDenseMapper::Entry* SemiDenseMapper::Find(KeyFrameId id) {
  const auto it = std::lower_bound(entries_.begin(), entries_.end(), id,
                                   [](const auto& entry, KeyFrameId i) { return entry->id < i; });
  return it != entries_.end() && (*it)->id == id ? it->get() : nullptr;
}

// The newest unprocessed keyframe that is followed by at least `delay` others.
SemiDenseMapper::Entry* SemiDenseMapper::NextDue(const MapSnapshot& map) {
  Entry* next = nullptr;
  int waiting = 0;
  for (size_t i = entries_.size(); i-- > 0;) {
    if (entries_[i]->estimated) continue;
    const MapId in = map.MapOf(entries_[i]->id);
    int followers = 0;
    for (size_t k = i + 1; k < entries_.size() && followers < settings_.delay; ++k) {
      followers += map.MapOf(entries_[k]->id) == in;
    }
    if (followers < settings_.delay) continue;
    if (!next) next = entries_[i].get();
    ++waiting;
  }
  report_.most_behind = std::max(report_.most_behind, waiting);
  return next;
}

// True if a baseline to a partner changed since the estimate by too large a share.
bool SemiDenseMapper::Moved(const MapSnapshot& map, const Entry& entry) const {
  if (!entry.estimated) return false;
  if (entry.of_other_camera) return true;
  const KeyFrame* keyframe = map.Find(entry.id);
  const std::optional<double> depth = MedianDepth(map, *keyframe);
  if (!depth) return false;
  for (const Entry::Partner& partner : entry.partners) {
    if (!map.Find(partner.id)) continue;
    const Se3 now = map.PoseOf(partner.id) * keyframe->T_camera_world.Inverse();
    const Eigen::Vector3d then = partner.T_partner_keyframe.t * (keyframe->scale / entry.scale);
    const double allowed = settings_.redo_baseline * then.norm();
    const double turn = RotationAngle(now, partner.T_partner_keyframe);
    if ((now.t - then).norm() > allowed || turn * *depth > allowed) return true;
  }
  return false;
}

SemiDenseMapper::Entry* SemiDenseMapper::NewestMoved(const MapSnapshot& map) {
  for (size_t i = entries_.size(); i-- > 0;) {
    if (Moved(map, *entries_[i])) return entries_[i].get();
  }
  return nullptr;
}

void SemiDenseMapper::Estimate(const MapSnapshot& map, Entry& entry,
                               std::span<const DepthView> views) {
  const KeyFrame& keyframe = *map.Find(entry.id);
  entry.estimated = true;
  entry.of_other_camera = false;
  entry.scale = keyframe.scale;
  entry.depth = PackedDepth(std::vector<Hypothesis>(entry.image.edges.size()));
  entry.partners.clear();
  ++report_.keyframes;
  report_.pixels += static_cast<int64_t>(entry.image.edges.size());
  if (settings_.from_sensor) {
    entry.depth = PackedDepth(entry.sensor);
    return;
  }
  const DepthRange range(map, keyframe, camera_, views);
  if (!range.known()) return;
  std::vector<EpipolarPair> pairs;
  for (KeyFrameId id : ChoosePartners(map, keyframe, settings_.keyframes,
                                      [&](KeyFrameId other) { return Find(other) != nullptr; })) {
    const KeyFrame& other = *map.Find(id);
    const Entry& partner = *Find(id);
    const Se3 T_other_reference = other.T_camera_world * keyframe.T_camera_world.Inverse();
    const Exposure exposure = CompareExposures(keyframe, entry.image, other, partner.image);
    pairs.emplace_back(entry.image, partner.image, WithExposure(entry.image.values, exposure),
                       T_other_reference);
    entry.partners.push_back({id, T_other_reference});
  }
  std::sort(pairs.begin(), pairs.end(), [](const EpipolarPair& a, const EpipolarPair& b) {
    return a.T_other_reference.t.squaredNorm() < b.T_other_reference.t.squaredNorm();
  });
  if (!pairs.empty()) {
    entry.depth = PackedDepth(DepthFromMotion(pairs, camera_, range, settings_, &report_.search));
  }
}

// Depth of the neighboring keyframes.
std::vector<DepthView> SemiDenseMapper::Views(const MapSnapshot& map, const KeyFrame& keyframe) {
  std::vector<DepthView> views;
  const auto usable = [&](KeyFrameId id) { return Find(id) && Find(id)->estimated; };
  for (KeyFrameId id : ChoosePartners(map, keyframe, settings_.keyframes, usable)) {
    const Entry& other = *Find(id);
    const KeyFrame& there = *map.Find(id);
    views.push_back({other.image.edges, other.depth.Unpack(other.scale / there.scale),
                     there.T_camera_world * keyframe.T_camera_world.Inverse()});
  }
  return views;
}

std::shared_ptr<const DepthMap> SemiDenseMapper::Checked(const MapSnapshot& map, const Entry& entry,
                                                         std::span<const DepthView> views) {
  const KeyFrame& keyframe = *map.Find(entry.id);
  std::vector<Hypothesis> depth = entry.depth.Unpack(entry.scale / keyframe.scale);
  if (settings_.cross_check) {
    depth = CrossCheck(entry.image.edges, depth, views, camera_,
                       {static_cast<float>(settings_.chi2_check), settings_.min_compatible});
  }
  const bool believed =
      settings_.from_sensor || AgreesWithLandmarks(map, keyframe, entry.image.edges, depth, camera_,
                                                   settings_.max_landmark_difference);
  auto result = std::make_shared<DepthMap>();
  result->width = camera_.width;
  result->height = camera_.height;
  result->scale = keyframe.scale;
  for (size_t i = 0; believed && i < depth.size(); ++i) {
    if (!depth[i].known()) continue;
    const EdgePixel& edge = entry.image.edges[i];
    result->pixels.push_back(
        {edge.x, edge.y, depth[i].inverse_depth, depth[i].sigma, entry.image.colors[i]});
  }
  result->pixels.shrink_to_fit();
  return result;
}

void SemiDenseMapper::CountBytes(const MapSnapshot& map) {
  report_.bytes = 0;
  for (const auto& entry : entries_) {
    report_.bytes +=
        entry->image.bytes() + entry->depth.bytes() + entry->sensor.capacity() * sizeof(Hypothesis);
    const KeyFrame* keyframe = map.Find(entry->id);
    if (keyframe && keyframe->depth)
      report_.bytes += keyframe->depth->pixels.capacity() * sizeof(DepthPixel);
  }
}

SemiDenseReport SemiDenseMapper::report() const {
  std::lock_guard<std::mutex> lock(told_mutex_);
  return told_;
}

void SemiDenseMapper::Tell() {
  std::lock_guard<std::mutex> lock(told_mutex_);
  told_ = report_;
}

void SemiDenseMapper::Process() {
  const MapSnapshot map = TakeIn();
  Entry* due = NextDue(map);
  if (due) WorkOn(map, *due);
  // A loop closure moves many keyframes. Until they are redone, each call also processes one of
  // them.
  if (due && map.corrections() == settled_corrections_) return;
  if (Entry* moved = NewestMoved(map)) {
    WorkOn(map, *moved);
  } else {
    settled_corrections_ = map.corrections();
  }
  Tell();
}

void SemiDenseMapper::WorkOn(const MapSnapshot& map, Entry& entry) {
  const std::vector<DepthView> views = Views(map, *map.Find(entry.id));
  Estimate(map, entry, views);
  const std::shared_ptr<const DepthMap> depth = Checked(map, entry, views);
  CountBytes(map_.Commit([&](MapCommit& commit) {
    if (KeyFrame* keyframe = commit.Edit(entry.id)) keyframe->depth = depth;
  }));
  Tell();
}

void SemiDenseMapper::Finish(const std::atomic<bool>* stop) {
  const auto enough = [stop] { return stop && stop->load(); };
  const MapSnapshot map = TakeIn();
  const auto views = [&](const Entry& entry) { return Views(map, *map.Find(entry.id)); };
  const auto estimate = [&](Entry& entry) { Estimate(map, entry, views(entry)); };
  for (const auto& entry : entries_) {
    if (!entry->estimated && !enough()) estimate(*entry);
  }
  for (size_t i = entries_.size(); i-- > 0 && !enough();) {
    if (Moved(map, *entries_[i])) estimate(*entries_[i]);
  }
  std::vector<std::pair<KeyFrameId, std::shared_ptr<const DepthMap>>> checked;
  for (const auto& entry : entries_) {
    if (entry->estimated && !enough())
      checked.push_back({entry->id, Checked(map, *entry, views(*entry))});
  }
  CountBytes(map_.Commit([&](MapCommit& commit) {
    for (const auto& [id, depth] : checked) {
      if (KeyFrame* keyframe = commit.Edit(id)) keyframe->depth = depth;
    }
  }));
  Tell();
}

}  // namespace alidade
