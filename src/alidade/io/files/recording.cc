#include "alidade/io/files/recording.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/association.h"
#include "alidade/io/files/image_file.h"

namespace alidade {
namespace {

std::string SizeText(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

class RecordingSource : public FrameSource {
 public:
  RecordingSource(Recording recording, Sensor sensor, ImagePreparation preparation,
                  cv::Size raw_size, bool camera_guessed)
      : frames_(std::move(recording.frames)),
        color_(recording.color),
        preparation_(std::move(preparation)),
        raw_size_(raw_size) {
    info_.name = std::move(recording.name);
    info_.kind = std::move(recording.kind);
    info_.sensor = sensor;
    info_.camera = preparation_.camera();
    info_.camera_guessed = camera_guessed;
    info_.lens_told = std::move(recording.lens_told);
    info_.R_camera_rectified = preparation_.R_camera_rectified();
    info_.frames = static_cast<int>(frames_.size());
  }

  const SourceInfo& Info() const override { return info_; }

  bool Seek(int frames) override {
    next_ = static_cast<size_t>(std::clamp(frames, 0, info_.frames));
    return true;
  }

  std::optional<SourceFrame> Next() override {
    if (next_ == frames_.size()) return std::nullopt;
    const RecordedFrame& recorded = frames_[next_];
    SourceFrame frame;
    frame.time = recorded.time;
    frame.stamp = recorded.stamp;
    frame.number = static_cast<int>(next_++);
    frame.problem = recorded.problem;
    if (!frame.problem.empty()) return frame;
    try {
      const GrayAndColor read = color_ ? ReadImageGrayAndColor(recorded.image)
                                       : GrayAndColor{ReadImageGray(recorded.image), {}};
      frame.image = preparation_.Left(Checked(read.gray, recorded.image));
      if (!read.color.empty()) frame.color = preparation_.Left(read.color);
    } catch (const Error& error) {
      frame.problem = error.what();
      return frame;
    }
    // A frame whose right or depth image is bad is still used as a monocular frame.
    if (info_.sensor == Sensor::kStereo && !recorded.right.empty()) {
      frame.right = OrWarn([&] {
        return preparation_.Right(Checked(ReadImageGray(recorded.right), recorded.right));
      });
    }
    if (info_.sensor == Sensor::kRgbd && !recorded.depth.empty()) {
      frame.depth = OrWarn(
          [&] { return preparation_.Depth(Checked(ReadDepth(recorded.depth), recorded.depth)); });
    }
    return frame;
  }

 private:
  cv::Mat Checked(cv::Mat image, const std::string& path) const {
    if (image.size() != raw_size_) {
      ThrowInput(path + " is " + SizeText(image.size()) + ", but the recording has " +
                 SizeText(raw_size_));
    }
    return image;
  }

  template <typename Read>
  static cv::Mat OrWarn(const Read& read) {
    try {
      return read();
    } catch (const Error& error) {
      LogWarning(error.what());
      return {};
    }
  }

  SourceInfo info_;
  std::vector<RecordedFrame> frames_;
  bool color_;
  ImagePreparation preparation_;
  cv::Size raw_size_;
  size_t next_ = 0;
};

}  // namespace

std::vector<RecordedFrame> FramesOf(const std::vector<StampedName>& list,
                                    const std::string& folder) {
  std::vector<RecordedFrame> frames;
  const auto first_good = std::find_if(
      list.begin(), list.end(), [](const StampedName& item) { return item.problem.empty(); });
  if (first_good == list.end()) ThrowInput(list.front().problem + " (and so are all other lines)");
  // Unusable lines get the time of the line before, to keep their place.
  double time = first_good->time;
  for (const StampedName& item : list) {
    if (item.problem.empty()) time = item.time;
    frames.push_back({time, item.stamp, folder + "/" + item.name, {}, {}, item.problem});
  }
  const auto earlier = [](const RecordedFrame& a, const RecordedFrame& b) {
    return a.time < b.time;
  };
  if (!std::is_sorted(frames.begin(), frames.end(), earlier)) {
    LogWarning("the time stamps of " + folder +
               " are not in order; the frames were sorted by time");
    std::stable_sort(frames.begin(), frames.end(), earlier);
  }
  const RecordedFrame* before = nullptr;
  for (RecordedFrame& frame : frames) {
    if (!frame.problem.empty()) continue;
    if (before && frame.time <= before->time) {
      frame.problem =
          frame.image + " has the time stamp of the previous frame (" + frame.stamp + ")";
    } else {
      before = &frame;
    }
  }
  return frames;
}

int AttachByTime(std::vector<RecordedFrame>& frames, std::string RecordedFrame::*which,
                 const std::vector<StampedName>& list, const std::string& folder, double max_dt) {
  std::vector<double> frame_times, list_times;
  // AssociateByTime() never pairs a NaN.
  const double never = std::numeric_limits<double>::quiet_NaN();
  for (const RecordedFrame& frame : frames)
    frame_times.push_back(frame.problem.empty() ? frame.time : never);
  for (const StampedName& item : list) {
    if (!item.problem.empty()) LogWarning(item.problem + "; this line is ignored");
    list_times.push_back(item.problem.empty() ? item.time : never);
  }
  const auto pairs = AssociateByTime(frame_times, list_times, max_dt);
  for (const auto& [frame, item] : pairs) {
    frames[static_cast<size_t>(frame)].*which = folder + "/" + list[static_cast<size_t>(item)].name;
  }
  return static_cast<int>(pairs.size());
}

cv::Size SizeOfImages(const Recording& recording) {
  std::string problem;
  for (const RecordedFrame& frame : recording.frames) {
    if (!frame.problem.empty()) continue;
    try {
      return ReadImageSize(frame.image);
    } catch (const Error& error) {
      if (problem.empty()) problem = error.what();
    }
  }
  ThrowInput("no image can be read: " + problem);
}

std::unique_ptr<FrameSource> PlayRecording(Recording recording, Sensor sensor,
                                           ImagePreparation preparation, cv::Size raw_size,
                                           bool camera_guessed) {
  return std::make_unique<RecordingSource>(std::move(recording), sensor, std::move(preparation),
                                           raw_size, camera_guessed);
}

}  // namespace alidade
