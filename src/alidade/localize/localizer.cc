#include "alidade/localize/localizer.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <span>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/id_map.h"
#include "alidade/localize/lens_cache.h"
#include "alidade/localize/part_errors.h"
#include "alidade/localize/shared_errors.h"
#include "alidade/map/keyframe_covariance.h"
#include "alidade/map/view.h"
#include "alidade/place/place_index.h"
#include "alidade/system/prepare.h"
#include "alidade/system/saved_settings.h"
#include "alidade/tracking/tracker.h"

namespace alidade {
namespace {

constexpr size_t kCandidates = 10;  // keyframes compared with a picture
// Of them that show the same place. Each is another start of the search: where the picture tells
// its pose badly (a distant wall), chance matches near a wrong start support it, and the poses
// found differ.
constexpr int kStarts = 3;
// Share of the expected landmarks that is found, relative to the keyframe's own share: mean and
// standard deviation at a right pose, and where another place looks alike. Estimated from few
// recordings (docs/benchmarks/localization.md).
constexpr double kRightShare = 1, kRightSigma = 0.2, kAlikeShare = 0.5, kAlikeSigma = 0.12;
// Probability, at most, that a place is found which only looks like that of the picture, by all
// else that is seen: two sections of a corridor.
constexpr double kAlike = 0.01;
// Two poses are one place when they differ by less than this: share of the depth, radians.
constexpr double kSamePosition = 0.05, kSameRotation = 0.05;

// The settings of tracking for pictures that stand alone.
SlamSettings AloneSettings(const SavedMap& saved) {
  SlamSettings settings = SettingsOf(saved);
  settings.sensor = Sensor::kMono;
  settings.semidense.enabled = false;
  settings.dynamics.mode = DynamicsMode::kOff;
  settings.tracker.align = false;
  return settings;
}

// The camera of the picture resized so that a pixel covers the same angle as in the map.
Camera AtResolutionOf(const Camera& map, Camera camera, int max_side) {
  camera.depth_factor = camera.baseline = 0;
  camera.readout = {};
  return camera.ScaledToWidth(WidthAtResolutionOf(map, camera, max_side));
}

cv::Mat Resized(const cv::Mat& picture, const Camera& to) {
  if (picture.cols == to.width && picture.rows == to.height) return picture;
  cv::Mat resized;
  cv::resize(picture, resized, {to.width, to.height}, 0, 0,
             to.width < picture.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return resized;
}

// Whether a keypoint can be where the landmark is: its patch must fit into its level of the
// pyramid (ExtractorSettings::border). Of small pictures a large part cannot.
bool CanBeFound(const Landmark& landmark, const Camera& camera, const Se3& T_camera_world,
                int border) {
  const auto view = ViewLandmark(landmark, camera, T_camera_world);
  if (!view) return false;
  const double edge = border * ScaleOfLevel(view->level);
  return view->pixel.x() >= edge && view->pixel.x() < camera.width - edge &&
         view->pixel.y() >= edge && view->pixel.y() < camera.height - edge;
}

struct Share {
  double expected = 0, found = 0;
  double value() const { return expected > 0 ? found / expected : 0; }
};

// Of the landmarks expected in a picture.
Share ShareFound(const TrackEstimate& estimate, const Camera& camera, const MapSnapshot& map,
                 int border) {
  Share share;
  for (const SightingCount& sighting : estimate.sightings) {
    const Landmark* landmark = map.Find(sighting.landmark);
    if (!landmark || !CanBeFound(*landmark, camera, estimate.placed.T_camera_world, border))
      continue;
    ++share.expected;
    share.found += sighting.found;
  }
  return share;
}

// The same of a keyframe itself.
Share ShareOf(const KeyFrame& keyframe, const SavedMap& saved, const TrackerSettings& settings) {
  LocalMapGatherer gatherer;
  const LocalMap local = gatherer.Gather(saved.map, keyframe.landmarks, keyframe.T_camera_world,
                                         settings.local_keyframes);
  IdSet<LandmarkId> own;
  for (const LandmarkId id : keyframe.landmarks) {
    if (id.valid()) own.Enter(id);
  }
  Share share;
  for (const Landmark* landmark : local.landmarks) {
    if (!CanBeFound(*landmark, saved.camera, keyframe.T_camera_world, settings.extractor.border))
      continue;
    ++share.expected;
    share.found += own.Contains(landmark->id);
  }
  return share;
}

// Odds of another place that looks alike to the right one. A place that looks alike agrees in what
// the two have in common and contradicts in the rest.
double OddsOfAlike(double agreement) {
  const double right = (std::min(agreement, kRightShare) - kRightShare) / kRightSigma;
  const double alike = (agreement - kAlikeShare) / kAlikeSigma;
  if (agreement < kAlikeShare)
    return kAlike * std::exp(0.5 * right * right) * kRightSigma / kAlikeSigma;
  return kAlike * std::exp(0.5 * (right * right - alike * alike)) * kRightSigma / kAlikeSigma;
}

bool SamePlace(const TrackEstimate& a, const TrackEstimate& b, const MapSnapshot& map) {
  if (map.MapOf(a.reference) != map.MapOf(b.reference)) return false;
  const Se3 T_a_b = a.placed.T_camera_world * b.placed.T_camera_world.Inverse();
  const double depth = MedianDepth(map, *map.Find(a.reference)).value_or(0);
  return T_a_b.t.norm() < kSamePosition * depth && T_a_b.Log().tail<3>().norm() < kSameRotation;
}

// Whether the keyframe shows what was found already.
bool Shows(const KeyFrame& keyframe, const TrackEstimate& found) {
  if (keyframe.id == found.reference) return true;
  return std::any_of(keyframe.covisible.begin(), keyframe.covisible.end(),
                     [&](const Neighbour& n) { return n.id == found.reference; });
}

}  // namespace

std::string NameOf(NoPlace why) {
  constexpr const char* kNames[] = {"", "blank", "unknown", "unlikely", "several"};
  return kNames[static_cast<size_t>(why)];
}

std::string WordsOf(NoPlace why) {
  switch (why) {
    case NoPlace::kNone:
      return "";
    case NoPlace::kBlank:
      return "the picture has too little texture: it is dark, blurred or shows a bare surface";
    case NoPlace::kUnknown:
      return "the map has no place that looks like the picture";
    case NoPlace::kUnlikely:
      return "a place looks like the picture, but too much of what should be visible is not";
    case NoPlace::kSeveral:
      return "several places of the map agree with the picture; take one that shows more";
  }
  return "";
}

struct Localizer::Parts {
  SavedMap saved;
  SlamSettings settings;
  PlaceIndex places;
  struct Uncertain {
    Matrix6d covariance = Matrix6d::Zero();
  };
  mutable LensCache lenses;
  IdMap<KeyFrameId, Uncertain> uncertain;  // KeyFrameCovariances()

  explicit Parts(SavedMap given)
      : saved(std::move(given)),
        settings(AloneSettings(saved)),
        places(settings.places, settings.seed) {
    const std::vector<KeyFrameId> ids = saved.map.KeyFrames();
    if (ids.empty()) ThrowInput("the map is empty: it has no keyframes");
    std::vector<PlaceKeyFrame> frames;
    frames.reserve(ids.size());
    for (const KeyFrameId id : ids) frames.emplace_back(id, saved.map.Find(id)->frame);
    places.Restore(saved.places, frames);
    MeasurementNoise noise = settings.tracker.noise;
    noise.right_from_sensor = saved.camera.baseline <= 0;
    for (const MapId map : saved.map.Maps()) {
      for (const auto& [id, covariance] : KeyFrameCovariances(saved.map, map, saved.camera, noise))
        uncertain[id].covariance = covariance;
    }
  }

  // Of the pose of a picture: how well it is known relative to the landmarks that it shows, what it
  // moves without parts of the image, how far other poses of the place are, and how well the
  // keyframe is known in the map, carried to the picture. Zero: unknown.
  Matrix6d CovarianceOf(const TrackEstimate& estimate, const Camera& camera,
                        const Matrix6d& spread) const {
    const Uncertain* of_map = uncertain.Find(estimate.reference);
    if (!of_map) return Matrix6d::Zero();
    const Se3 T_camera_keyframe = estimate.placed.T_camera_world *
                                  saved.map.Find(estimate.reference)->T_camera_world.Inverse();
    const MeasurementNoise& noise = settings.tracker.noise;
    return spread + estimate.placed.covariance +
           SharedErrors(estimate.placed, camera, saved.map, noise) +
           PartErrors(estimate.placed, camera, saved.map, noise) +
           Carried(T_camera_keyframe, of_map->covariance);
  }

  // The poses that agree with the picture, up to kStarts for each place, the most probable first.
  std::vector<TrackEstimate> Find(Tracker& tracker, const std::shared_ptr<const Frame>& frame,
                                  Placement& told) const {
    std::vector<TrackEstimate> found;
    for (const PlaceMatch& match : places.Query(*frame, {}, kCandidates)) {
      const KeyFrame& keyframe = *saved.map.Find(match.id);
      const auto shown = [&](const TrackEstimate& one) { return Shows(keyframe, one); };
      if (std::count_if(found.begin(), found.end(), shown) >= kStarts) continue;
      ++told.tried;
      TrackEstimate estimate = tracker.Relocalise(frame, saved.map, {&match.id, 1});
      if (estimate.tracked) found.push_back(std::move(estimate));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const TrackEstimate& a, const TrackEstimate& b) {
                       return a.placed.log_odds > b.placed.log_odds;
                     });
    return found;
  }

  // Of the poses found, the best one first.
  struct Rivals {
    double odds = 0;                     // of the other places to the best pose
    Matrix6d spread = Matrix6d::Zero();  // of the poses of its place: a mixture, about the best one
  };
  Rivals RivalsOf(std::span<const TrackEstimate> found) const {
    const TrackEstimate& best = found.front();
    std::vector<const TrackEstimate*> seen = {&best};  // one for each place
    Rivals rivals;
    double weights = 0;
    for (const TrackEstimate& one : found) {
      const double odds = std::exp(one.placed.log_odds - best.placed.log_odds);
      const auto place = std::find_if(seen.begin(), seen.end(), [&](const TrackEstimate* other) {
        return SamePlace(*other, one, saved.map);
      });
      if (place == seen.begin()) {
        const Vector6d xi =
            (one.placed.T_camera_world * best.placed.T_camera_world.Inverse()).Log();
        rivals.spread += odds * xi * xi.transpose();
        weights += odds;
      } else if (place == seen.end()) {
        rivals.odds += odds;
        seen.push_back(&one);
      }
    }
    rivals.spread /= weights;
    return rivals;
  }

  // The best of the poses, and whether it is believed. Exactly one of the places is right, or one
  // that looks alike, or none: P = 1 / (1 + sum of the odds to the best).
  void Judge(std::span<const TrackEstimate> found, const Camera& camera, double min_probability,
             Placement& told) const {
    const TrackEstimate& best = found.front();
    const int border = settings.tracker.extractor.border;
    const double share = ShareFound(best, camera, saved.map, border).value();
    const double usual = ShareOf(*saved.map.Find(best.reference), saved, settings.tracker).value();
    told.agreement = share / std::max(usual, 1e-3);
    const double alike = OddsOfAlike(told.agreement);
    const Rivals rivals = RivalsOf(found);
    told.probability = 1 / (1 + std::exp(-best.placed.log_odds) + alike + rivals.odds);
    told.T_world_camera = best.placed.T_camera_world.Inverse();
    told.covariance = CovarianceOf(best, camera, rivals.spread);
    told.keyframe = best.reference;
    told.map = saved.map.MapOf(best.reference);
    told.meters = InMeters(saved, told.map);
    told.expected = static_cast<int>(best.sightings.size());
    told.inliers = best.placed.inliers;
    const double enough =
        min_probability > 0 ? min_probability : settings.tracker.evidence.min_probability;
    told.why = told.probability >= enough ? NoPlace::kNone
               : rivals.odds > alike      ? NoPlace::kSeveral
                                          : NoPlace::kUnlikely;
  }
};

Localizer::Localizer(SavedMap saved) : parts_(std::make_unique<const Parts>(std::move(saved))) {}
Localizer::~Localizer() = default;
const SavedMap& Localizer::saved() const { return parts_->saved; }

Placement Localizer::Localize(const cv::Mat& image, const Calibration& calibration,
                              double min_probability) const {
  const SlamSettings& settings = parts_->settings;
  const Camera& map_camera = parts_->saved.camera;
  const ImagePreparation lens = parts_->lenses.Of(calibration);
  const Camera camera = AtResolutionOf(map_camera, lens.camera(), settings.max_image_side);
  const cv::Mat gray = Prepare({.image = image}, lens.camera(), lens.camera(), settings).image;

  TrackerSettings tracking = settings.tracker;
  tracking.extractor.features = FeaturesAsDenseAs(map_camera, camera, tracking.extractor.features);
  Tracker tracker(camera, tracking);
  const std::shared_ptr<const Frame> frame =
      tracker.Extract(Resized(lens.Left(gray), camera), {}, {}, 0, 0);

  Placement placement;
  placement.keypoints = static_cast<int>(frame->keypoints.size());
  if (placement.keypoints < settings.tracker.min_tracked) {
    placement.why = NoPlace::kBlank;
    return placement;
  }
  const std::vector<TrackEstimate> found = parts_->Find(tracker, frame, placement);
  if (!found.empty()) parts_->Judge(found, camera, min_probability, placement);
  return placement;
}

}  // namespace alidade
