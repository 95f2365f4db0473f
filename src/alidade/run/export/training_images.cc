#include "alidade/run/export/training_images.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/read_ahead.h"
#include "alidade/run/export/image_masks.h"
#include "alidade/run/export/image_names.h"
#include "alidade/run/export/pinhole_images.h"
#include "alidade/run/export/posed_frames.h"

namespace alidade {
namespace {

constexpr int kTrainingQuality = 95;

// Sum of colors, red green blue.
struct ColorSum {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
};

const cv::Mat& PictureIn(const SourceFrame& frame) {
  return frame.color.empty() ? frame.image : frame.color;
}

// Bilinear; red green blue.
Eigen::Vector3d ColorAt(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const double x = std::clamp(pixel.x(), 0.0, image.cols - 1.0),
               y = std::clamp(pixel.y(), 0.0, image.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, image.cols - 1), bottom = std::min(top + 1, image.rows - 1);
  const auto at = [&](int u, int v) -> Eigen::Vector3d {
    if (image.channels() == 1) return Eigen::Vector3d::Constant(image.at<uint8_t>(v, u));
    const auto& bgr = image.at<cv::Vec3b>(v, u);
    return {double(bgr[2]), double(bgr[1]), double(bgr[0])};
  };
  const double u = x - left, v = y - top;
  return (1 - v) * ((1 - u) * at(left, top) + u * at(right, top)) +
         v * ((1 - u) * at(left, bottom) + u * at(right, bottom));
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
        poses_(saved, part, recording.folder, info_.R_camera_rectified),
        pinhole_(saved.camera, {info_.camera.width, info_.camera.height},
                 {settings.centered, poses_.MarginFor(saved.camera)}),
        names_(info_),
        check_(saved) {
    if (settings.choice.kind != FrameChoice::Kind::kKeyframes && !poses_.has_trajectory()) {
      ThrowUsage(
          "--images other than keyframes needs the result folder of the run, whose trajectory has "
          "the poses of all frames");
    }
    if (settings.masks) masks_.emplace(recording.folder);
    used_.insert(part.landmarks.begin(), part.landmarks.end());
    set_.model.camera = pinhole_.camera();
  }

  void Take(const SourceFrame& frame) {
    if (!frame.problem.empty() || frame.image.empty()) return;
    std::optional<PosedFrame> posed;
    for (const PosedFrame& candidate : poses_.At(frame.time)) {
      if (candidate.keyframe.valid()) {
        if (done_.count(candidate.keyframe) > 0) continue;
        if (!check_.Shows(frame.image, *saved_.map.Find(candidate.keyframe))) {
          others_.insert(candidate.keyframe);
          continue;
        }
        done_.insert(candidate.keyframe);
        others_.erase(candidate.keyframe);
        AddColors(frame, *saved_.map.Find(candidate.keyframe));
      }
      posed = candidate;
      break;
    }
    if (posed) Choose(frame, *posed);
  }

  TrainingSet Finish(const std::string& source) {
    Flush();
    if (done_.empty() && others_.empty())
      ThrowInput(source +
                 " has no frame at the times of the map's keyframes: it was changed since "
                 "the run, or is another recording");
    if (done_.empty())
      ThrowInput(source +
                 ": its images do not show what the map was made of: it was changed since "
                 "the run, or is another recording");
    AddPoints();
    set_.other = static_cast<int>(others_.size());
    set_.missing = static_cast<int>(poses_.keyframes() - done_.size() - others_.size());
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
    const ReadoutMotion readout = poses_.MotionAt(frame.time);
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
    set_.model.images.push_back(std::move(written));
  }

  void AddColors(const SourceFrame& frame, const KeyFrame& keyframe) {
    const cv::Mat& picture = PictureIn(frame);
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.landmarks[i].valid() || used_.count(keyframe.landmarks[i]) == 0) continue;
      const Keypoint& keypoint = keyframe.frame->keypoints[i];
      ColorSum& color = colors_[keyframe.landmarks[i]];
      color.sum += ColorAt(picture, pinhole_.InRecorded({keypoint.raw_x, keypoint.raw_y}));
      ++color.count;
    }
  }

  void AddPoints() {
    ColmapModel& model = set_.model;
    for (LandmarkId id : part_.landmarks) {
      const Landmark& landmark = *saved_.map.Find(id);
      ColmapModel::Point point;
      point.p_world = landmark.p_world;
      double sum = 0;
      int in_front = 0;
      for (const Observation& seen : landmark.observations) {
        const auto image = images_.find(seen.keyframe);
        if (image == images_.end()) continue;
        const int keypoint = keypoints_.at(seen.keyframe)[static_cast<size_t>(seen.keypoint)];
        if (keypoint < 0) continue;
        point.track.push_back({image->second, keypoint});
        const ColmapModel::Image& written = model.images[static_cast<size_t>(image->second)];
        const Eigen::Vector3d p_camera = written.T_camera_world * landmark.p_world;
        if (!(p_camera.z() > 0)) continue;
        sum += (model.camera.Project(p_camera) -
                written.keypoints[static_cast<size_t>(keypoint)].pixel)
                   .norm();
        ++in_front;
      }
      // Frames that are no keyframes observe nothing: their points need no observations either.
      if (settings_.choice.kind == Kind::kKeyframes &&
          static_cast<int>(point.track.size()) < settings_.min_observations)
        continue;
      const auto color = colors_.find(id);
      if (color == colors_.end()) continue;  // of keyframes that were not found
      const Eigen::Vector3d mean = color->second.sum / color->second.count;
      for (int channel = 0; channel < 3; ++channel)
        point.color[static_cast<size_t>(channel)] =
            static_cast<uint8_t>(std::lround(mean[channel]));
      if (in_front > 0) point.error = sum / in_front;
      for (const ColmapModel::Seen& seen : point.track) {
        model.images[static_cast<size_t>(seen.image)]
            .keypoints[static_cast<size_t>(seen.keypoint)]
            .point = static_cast<int>(model.points.size());
      }
      model.points.push_back(std::move(point));
    }
  }

  const SavedMap& saved_;
  const MapPart& part_;
  const TrainingSettings settings_;
  ExportFolder& folder_;
  const SourceInfo info_;
  const PosedFrames poses_;
  const PinholeImages pinhole_;
  ImageNames names_;
  ImageCheck check_;
  std::optional<ImageMasks> masks_;
  TrainingSet set_;
  std::set<LandmarkId> used_;
  std::map<LandmarkId, ColorSum> colors_;
  std::map<KeyFrameId, int> images_;                  // indices in the model
  std::map<KeyFrameId, std::vector<int>> keypoints_;  // index in the image's, -1: outside
  std::set<KeyFrameId> done_, others_;                // found in the recording, or not the same
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
  const int total = recording.source->Info().frames;
  ReadAhead frames(std::move(recording.source));
  int read = 0;
  while (const std::optional<SourceFrame> frame = frames.Next()) {
    writer.Take(*frame);
    if (progress && !progress(++read, total)) throw ExportStopped();
  }
  return writer.Finish(recording.path);
}

}  // namespace alidade
