#include "alidade/run/export/training_images.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/read_ahead.h"
#include "alidade/run/export/frame_matcher.h"
#include "alidade/run/export/image_masks.h"
#include "alidade/run/export/image_names.h"
#include "alidade/run/export/landmark_colors.h"
#include "alidade/run/export/map_models.h"
#include "alidade/run/export/pinhole_images.h"

namespace alidade {
namespace {

constexpr int kTrainingQuality = 95;  // JPEG
constexpr std::array<uint8_t, 3> kUnknownColor = {128, 128, 128};

const cv::Mat& PictureIn(const SourceFrame& frame) {
  return frame.color.empty() ? frame.image : frame.color;
}

// Reads the recording once, in its own thread.
void ForEachFrame(OwnRecording& recording, const ExportProgress& progress,
                  const std::function<void(const SourceFrame&)>& take) {
  const int total = recording.source->Info().frames;
  ReadAhead frames(std::move(recording.source));
  int read = 0;
  while (const std::optional<SourceFrame> frame = frames.Next()) {
    take(*frame);
    if (progress && !progress(++read, total)) throw ExportStopped();
  }
}

class TrainingWriter {
 public:
  TrainingWriter(const SavedMap& saved, const MapPart& part, const OwnRecording& recording,
                 const TrainingSettings& settings, ExportFolder& folder)
      : saved_(saved),
        part_(part),
        settings_(settings),
        folder_(folder),
        info_(recording.source->Info()),
        frames_(saved, part, recording.folder, info_.R_camera_rectified, recording.T_now_then),
        pinhole_(saved.camera, {info_.camera.width, info_.camera.height},
                 {settings.centered, frames_.poses().MarginFor(saved.camera)}),
        names_(recording),
        colors_(saved, part, {info_.camera.width, info_.camera.height}) {
    if (settings.choice.kind != FrameChoice::Kind::kKeyframes &&
        !frames_.poses().has_trajectory()) {
      ThrowUsage(
          "--images other than keyframes needs the result folder of the run, whose trajectory has "
          "the poses of all frames");
    }
    if (settings.masks) masks_.emplace(recording.folder);
    set_.model.camera = pinhole_.camera();
  }

  void Take(const SourceFrame& frame) {
    const std::optional<PosedFrame> posed = frames_.Match(frame);
    if (!posed) return;
    if (posed->keyframe.valid()) colors_.Add(PictureIn(frame), *saved_.map.Find(posed->keyframe));
    Choose(frame, *posed);
  }

  TrainingSet Finish(const std::string& source) {
    Flush();
    frames_.CheckFound(source);
    AddPoints();
    set_.other = frames_.other();
    set_.missing = frames_.missing();
    return std::move(set_);
  }

 private:
  using Kind = FrameChoice::Kind;

  void Choose(const SourceFrame& frame, const PosedFrame& posed) {
    switch (settings_.choice.kind) {
      case Kind::kKeyframes:
        if (posed.keyframe.valid()) Write(frame, posed);
        return;
      case Kind::kEvery:
        if (frame.number % settings_.choice.every == 0) Write(frame, posed);
        return;
      case Kind::kSharpest:
        break;
    }
    if (!first_time_) first_time_ = frame.time;
    const std::pair window(frame.part,
                           std::floor((frame.time - *first_time_) * settings_.choice.rate));
    if (best_ && window != window_) Flush();
    const double sharpness = SharpnessOf(frame.image);
    if (best_ && sharpness <= sharpness_) return;
    best_ = std::pair(frame, posed);
    sharpness_ = sharpness;
    window_ = window;
  }

  void Flush() {
    if (best_) Write(best_->first, best_->second);
    best_.reset();
  }

  void Write(const SourceFrame& frame, const PosedFrame& posed) {
    const ReadoutMotion readout = frames_.poses().MotionAt(frame.time);
    const std::string name = names_.NameOf(frame);
    const cv::Mat image = pinhole_.Apply(PictureIn(frame), readout);
    folder_.Write("images/" + name, ImageNames::IsJpeg(name) ? EncodeJpeg(image, kTrainingQuality)
                                                             : EncodePng(image));
    if (masks_) {
      const cv::Mat mask = masks_->Of(frame, {info_.camera.width, info_.camera.height});
      folder_.Write("masks/" + name + ".png", EncodePng(pinhole_.ApplyNearest(mask, readout)));
      set_.masks = true;
    }
    ColmapModel::Image written{name, posed.T_camera_world, {}};
    if (posed.keyframe.valid()) {
      const auto& keypoints = saved_.map.Find(posed.keyframe)->frame->keypoints;
      std::vector<int>& numbers = keypoints_[posed.keyframe];
      numbers.assign(keypoints.size(), -1);
      for (size_t i = 0; i < keypoints.size(); ++i) {
        const Eigen::Vector2d pixel =
            pinhole_.InPinhole({keypoints[i].raw_x, keypoints[i].raw_y}, readout);
        if (!pinhole_.Holds(pixel)) continue;
        numbers[i] = static_cast<int>(written.keypoints.size());
        written.keypoints.push_back({pixel});
      }
      images_[posed.keyframe] = static_cast<int>(set_.model.images.size());
    }
    const int landmarks = posed.keyframe.valid() ? LandmarksOf(posed.keyframe) : 0;
    if (set_.shown.empty() || landmarks > shown_landmarks_) {
      set_.shown = image;
      set_.shown_image = static_cast<int>(set_.model.images.size());
      shown_landmarks_ = landmarks;
    }
    set_.model.images.push_back(std::move(written));
  }

  int LandmarksOf(KeyFrameId id) const {
    const auto& landmarks = saved_.map.Find(id)->landmarks;
    return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                          [](LandmarkId landmark) { return landmark.valid(); }));
  }

  void AddPoints() {
    ColmapModel& model = set_.model;
    const auto place = [&](const Observation& seen) -> std::optional<ColmapModel::Seen> {
      const auto image = images_.find(seen.keyframe);
      if (image == images_.end()) return std::nullopt;
      const int keypoint = keypoints_.at(seen.keyframe)[static_cast<size_t>(seen.keypoint)];
      if (keypoint < 0) return std::nullopt;
      return ColmapModel::Seen{image->second, keypoint};
    };
    for (LandmarkId id : part_.landmarks) {
      ColmapModel::Point point = PointOf(model, *saved_.map.Find(id), place);
      // Frames that are no keyframes observe nothing: their points need no observations either.
      if (settings_.choice.kind == Kind::kKeyframes &&
          static_cast<int>(point.track.size()) < settings_.min_observations)
        continue;
      const auto color = colors_.Of(id);
      if (!color) continue;  // of keyframes that were not found
      point.color = *color;
      AddPoint(model, std::move(point));
    }
  }

  const SavedMap& saved_;
  const MapPart& part_;
  const TrainingSettings settings_;
  ExportFolder& folder_;
  const SourceInfo info_;
  FrameMatcher frames_;
  const PinholeImages pinhole_;
  ImageNames names_;
  LandmarkColors colors_;
  std::optional<ImageMasks> masks_;
  TrainingSet set_;
  int shown_landmarks_ = 0;
  std::map<KeyFrameId, int> images_;                  // indices in the model
  std::map<KeyFrameId, std::vector<int>> keypoints_;  // index in the image's, -1: outside
  // The sharpest frame of the present window.
  std::optional<std::pair<SourceFrame, PosedFrame>> best_;
  double sharpness_ = 0;
  std::pair<int, double> window_;
  std::optional<double> first_time_;
};

}  // namespace

TrainingSet WriteTrainingImages(const SavedMap& saved, const MapPart& part, OwnRecording& recording,
                                const TrainingSettings& settings, const ExportProgress& progress,
                                ExportFolder& folder) {
  TrainingWriter writer(saved, part, recording, settings, folder);
  ForEachFrame(recording, progress, [&](const SourceFrame& frame) { writer.Take(frame); });
  return writer.Finish(recording.path);
}

Cloud ColoredCloud(const SavedMap& saved, const MapPart& part, OwnRecording& recording,
                   const ExportProgress& progress) {
  const SourceInfo info = recording.source->Info();
  FrameMatcher frames(saved, part, recording.folder, info.R_camera_rectified, recording.T_now_then);
  LandmarkColors colors(saved, part, {info.camera.width, info.camera.height});
  ForEachFrame(recording, progress, [&](const SourceFrame& frame) {
    const std::optional<PosedFrame> posed = frames.Match(frame);
    if (posed && posed->keyframe.valid())
      colors.Add(PictureIn(frame), *saved.map.Find(posed->keyframe));
  });
  frames.CheckFound(recording.path);
  Cloud cloud = CloudOf(saved, part);
  for (LandmarkId id : part.landmarks)
    cloud.colors.push_back(colors.Of(id).value_or(kUnknownColor));
  return cloud;
}

}  // namespace alidade
