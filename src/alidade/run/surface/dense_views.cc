#include "alidade/run/surface/dense_views.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/features/color.h"
#include "alidade/features/depth_image.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/read_ahead.h"
#include "alidade/io/text.h"
#include "alidade/io/trajectory.h"
#include "alidade/map/depth_cloud.h"
#include "alidade/map/view.h"
#include "alidade/run/export/frame_matcher.h"
#include "alidade/run/export/map_files.h"
#include "alidade/run/export/own_recording.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/surface/timed_frames.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/surface/stereo_depth.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

// Standard deviation of semi-dense depth with one camera, as a share of the median depth: the 90 %
// quantile of its errors over 1.645 (docs/benchmarks/surface.md).
constexpr double kSemiDenseShare = 0.01;

MapPart PartAt(const SavedMap& saved, int number) {
  const std::vector<MapPart> parts = PartsOf(saved.map);
  if (number < 0 || number >= static_cast<int>(std::max<size_t>(1, parts.size())))
    ThrowUsage("--part " + std::to_string(number) + ": the file has " +
               std::to_string(parts.size()) + " maps, numbered from 0");
  return parts.empty() ? MapPart() : parts[static_cast<size_t>(number)];
}

cv::Mat1f InMeters(const cv::Mat& depth, const Camera& camera) {
  const DepthImage image(depth, camera);
  cv::Mat1f meters(depth.size());
  for (int y = 0; y < depth.rows; ++y) {
    float* row = meters[y];
    for (int x = 0; x < depth.cols; ++x) row[x] = image.At(x, y);
  }
  return meters;
}

// Median depth of the landmarks in a keyframe, over all keyframes; 1 if there is none.
double UsualDepth(const SavedMap& saved, const MapPart& part) {
  std::vector<double> depths;
  for (KeyFrameId id : part.keyframes) {
    if (const auto depth = MedianDepth(saved.map, *saved.map.Find(id)); depth && *depth > 0)
      depths.push_back(*depth);
  }
  if (depths.empty()) return 1;
  std::nth_element(depths.begin(), depths.begin() + static_cast<ptrdiff_t>(depths.size() / 2),
                   depths.end());
  return depths[depths.size() / 2];
}

// Depth that all but 1 % of the keypoints exceed, with a margin for what has no keypoint.
double NearestDepth(const SavedMap& saved, const MapPart& part) {
  constexpr double kShare = 0.01, kMargin = 0.7;
  std::vector<float> depths;
  for (KeyFrameId id : part.keyframes) {
    for (const Keypoint& keypoint : saved.map.Find(id)->frame->keypoints) {
      if (keypoint.has_depth()) depths.push_back(keypoint.depth);
    }
  }
  if (depths.empty()) return 0.5;
  const auto nth =
      depths.begin() + static_cast<ptrdiff_t>(kShare * static_cast<double>(depths.size()));
  std::nth_element(depths.begin(), nth, depths.end());
  return kMargin * *nth;
}

ViewWorld WorldFor(const SavedMap& saved, const MapPart& part, const Eigen::Matrix3d& turn,
                   bool scaled) {
  const MapWorld known = WorldOf(saved, part);
  ViewWorld world;
  world.meters = known.meters || saved.sensor != NameOf(Sensor::kMono) || scaled;
  if (known.KnowsDown()) {
    world.up = turn * -known.down;
    world.up_sigma = known.down_sigma;
  }
  return world;
}

// Views of a recording with depth or a second camera.
class RecordedViews {
 public:
  RecordedViews(const std::string& path, const SavedMap& saved, const MapPart& part,
                const DenseViewSettings& settings)
      : settings_(settings),
        recording_(OpenOwnRecording(path, saved, settings.source, settings.camera)),
        info_(recording_.source->Info()),
        turn_{info_.R_camera_rectified, Eigen::Vector3d::Zero()},
        frames_(saved, part, recording_.folder, info_.R_camera_rectified, recording_.T_now_then),
        pinhole_(saved.camera, {info_.camera.width, info_.camera.height},
                 {false, frames_.poses().MarginFor(saved.camera)}) {
    summary_.kind = info_.sensor == Sensor::kStereo ? DepthKind::kStereo : DepthKind::kSensor;
    summary_.world = WorldFor(saved, part, info_.R_camera_rectified, settings.scale_by.has_value());
    recorded_ = saved.camera;
    const double larger = static_cast<double>(info_.camera.width) / saved.camera.width;
    recorded_.fx *= larger;
    recorded_.depth_factor = info_.camera.depth_factor;
    if (summary_.kind == DepthKind::kStereo) nearest_ = NearestDepth(saved, part);
    if (settings.every > 0 && !frames_.poses().has_trajectory())
      ThrowUsage(
          "--every needs the result folder of the run, whose trajectory has the poses of "
          "all frames");
  }

  ViewSummary ForEach(const ExportProgress& progress,
                      const std::function<void(const DenseView&)>& take) {
    const std::vector<double> times = frames_.poses().Times(settings_.every == 0);
    ReadAhead frames(std::make_unique<TimedFrames>(std::move(recording_.source), times));
    int read = 0, with_pose = 0;
    while (const auto frame = frames.Next()) {
      if (progress && !progress(++read, static_cast<int>(times.size()))) throw ExportStopped();
      const auto posed = frames_.Match(*frame);
      if (!posed || !Wanted(*posed, with_pose)) continue;
      if (const auto view = ViewOf(*frame, *posed)) {
        summary_.world.path.push_back(turn_ * posed->T_camera_world.Inverse() * turn_.Inverse());
        ++summary_.views;
        summary_.inverse_sigma = view->inverse_sigma;
        take(*view);
      } else {
        ++summary_.without;
      }
    }
    frames_.CheckFound(recording_.path);
    summary_.without += frames_.missing();
    return summary_;
  }

 private:
  // Keyframes; or each N-th frame.
  bool Wanted(const PosedFrame& posed, int& with_pose) const {
    if (settings_.every == 0) return posed.keyframe.valid();
    return with_pose++ % settings_.every == 0;
  }

  std::optional<DenseView> ViewOf(const SourceFrame& frame, const PosedFrame& posed) {
    positions_ = pinhole_.PositionsAt(frames_.poses().MotionAt(frame.time), std::move(positions_));
    DenseView view;
    if (summary_.kind == DepthKind::kStereo) {
      if (frame.right.empty()) return std::nullopt;
      const StereoMatch match = MatchStereo(frame.image, frame.right, recorded_, nearest_);
      view.depth = match.depth;
      view.inverse_sigmas = PinholeImages::Nearest(match.inverse_sigmas, positions_);
      view.inverse_sigma = kDisparitySigma / (recorded_.fx * recorded_.baseline);
    } else {
      if (frame.depth.empty()) return std::nullopt;
      view.depth = InMeters(frame.depth, recorded_);
      view.inverse_sigma = kSensorInverseSigma;
    }
    view.depth = WithoutSteps(PinholeImages::Nearest(view.depth, positions_));
    // A voxel is the mean of some pixels of each view: nothing is gained by interpolating them.
    if (settings_.color)
      view.color = BgrOf(
          PinholeImages::Nearest(frame.color.empty() ? frame.image : frame.color, positions_));
    view.camera = pinhole_.camera();
    view.T_world_camera = turn_ * posed.T_camera_world.Inverse();
    return view;
  }

  const DenseViewSettings settings_;
  OwnRecording recording_;
  const SourceInfo info_;
  const Se3 turn_;
  FrameMatcher frames_;
  const PinholeImages pinhole_;
  cv::Mat positions_;  // PinholeImages::PositionsAt() of the last frame
  Camera recorded_;    // focal length, baseline and depth factor for images as recorded
  double nearest_ = 0;
  ViewSummary summary_;
};

// "STAMP NAME" of the list of depth images of the part.
std::vector<std::pair<std::string, std::string>> DepthListIn(const std::string& folder, int part) {
  std::vector<std::pair<std::string, std::string>> list;
  const std::string path = folder + "/" + NumberedFile("depth", static_cast<size_t>(part));
  if (folder.empty() || !IsFile(path)) return list;
  const std::string text = ReadFile(path);
  for (const TextLine& line : ContentLines(text)) {
    const auto words = Fields(line.text);
    if (words.size() == 2) list.push_back({std::string(words[0]), std::string(words[1])});
  }
  return list;
}

ViewSummary ForEachSemiDense(const std::string& path, const SavedMap& saved, const MapPart& part,
                             const DenseViewSettings& settings, const ExportProgress& progress,
                             const std::function<void(const DenseView&)>& take) {
  const std::string folder = ResultFolderOf(path);
  const auto list = DepthListIn(folder, settings.part);
  if (list.empty())
    ThrowInput(path +
               ": one camera gives no depth by itself: run it again with --semidense, whose depth "
               "images are used");
  const Eigen::Matrix3d turn = WrittenTurnIn(saved, part, folder);
  ViewSummary summary;
  summary.kind = DepthKind::kSemiDense;
  summary.world = WorldFor(saved, part, turn, settings.scale_by.has_value());
  const PosedFrames poses(saved, part, "", turn, {});
  const PinholeImages pinhole(saved.camera, {saved.camera.width, saved.camera.height});
  Camera drawn = saved.camera;
  drawn.depth_factor = kDepthPictureFactor;
  const double usual = UsualDepth(saved, part);
  int read = 0;
  for (const auto& [stamp, name] : list) {
    if (progress && !progress(++read, static_cast<int>(list.size()))) throw ExportStopped();
    const auto time = ParseNumber(stamp);
    const auto found = time ? poses.At(*time) : std::vector<PosedFrame>();
    if (found.empty()) {
      ++summary.without;
      continue;
    }
    DenseView view;
    view.depth = pinhole.ApplyNearest(InMeters(ReadDepth(folder + "/" + name), drawn));
    view.camera = pinhole.camera();
    const Se3 turned{turn, Eigen::Vector3d::Zero()};
    view.T_world_camera = turned * found.front().T_camera_world.Inverse();
    view.inverse_sigma = kSemiDenseShare / usual;
    summary.world.path.push_back(view.T_world_camera * turned.Inverse());
    ++summary.views;
    summary.inverse_sigma = view.inverse_sigma;
    take(view);
  }
  return summary;
}

DenseView Scaled(DenseView view, double scale) {
  view.T_world_camera.t *= scale;
  view.depth *= scale;
  view.inverse_sigma /= scale;
  view.inverse_sigmas /= scale;
  return view;
}

}  // namespace

ViewSummary ForEachDenseView(const std::string& path, const SavedMap& saved,
                             const DenseViewSettings& settings, const ExportProgress& progress,
                             const std::function<void(const DenseView&)>& take) {
  const MapPart part = PartAt(saved, settings.part);
  if (part.keyframes.empty()) ThrowInput(path + ": the map is empty");
  ExportSettings scaling;
  scaling.part = settings.part;
  scaling.scale_by = settings.scale_by;
  const double scale = ScaleFor(path, saved, scaling);
  const auto take_scaled = [&](const DenseView& view) {
    take(scale == 1 ? view : Scaled(view, scale));
  };
  ViewSummary summary =
      saved.sensor == NameOf(Sensor::kMono)
          ? ForEachSemiDense(path, saved, part, settings, progress, take_scaled)
          : RecordedViews(path, saved, part, settings).ForEach(progress, take_scaled);
  for (Se3& pose : summary.world.path) pose.t *= scale;
  if (summary.views == 0)
    ThrowInput(path + ": no frame with a pose has depth: nothing to make a surface of");
  return summary;
}

}  // namespace alidade
