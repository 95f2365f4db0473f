#include "alidade/io/files/datasets/recording.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/association.h"
#include "alidade/io/files/datasets/list_order.h"
#include "alidade/io/files/depth_size.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/gray_levels.h"

namespace alidade {

namespace {

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
    info_.depth_assumed = recording.depth_assumed;
    info_.fps_assumed = recording.fps_assumed;
    info_.lens_told = std::move(recording.lens_told);
    info_.told = std::move(recording.told);
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
    frame.part = recorded.part;
    frame.problem = recorded.problem;
    if (!frame.problem.empty()) return frame;
    try {
      const GrayAndColor read = ReadImageAsStored(recorded.image, color_);
      const cv::Mat gray = levels_.To8Bit(read.gray, frame.time);
      frame.image = preparation_.Left(Checked(gray, recorded.image));
      if (!read.color.empty()) frame.color = preparation_.Left(read.color);
    } catch (const Error& error) {
      frame.problem = error.what();
      return frame;
    }
    if (info_.sensor == Sensor::kStereo && !recorded.right.empty()) {
      frame.right = OrIncomplete(frame, [&] {
        const cv::Mat right = ReadImageAsStored(recorded.right, false).gray;
        return preparation_.Right(Checked(levels_.To8Bit(right, frame.time), recorded.right));
      });
    }
    if (info_.sensor == Sensor::kRgbd && !recorded.depth.empty()) {
      frame.depth = OrIncomplete(frame, [&] {
        const cv::Mat depth = ScaledUpDepth(ReadDepth(recorded.depth), raw_size_);
        return preparation_.Depth(Checked(depth, recorded.depth));
      });
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
  static cv::Mat OrIncomplete(SourceFrame& frame, const Read& read) {
    try {
      return read();
    } catch (const Error& error) {
      frame.incomplete = error.what();
      return {};
    }
  }

  SourceInfo info_;
  std::vector<RecordedFrame> frames_;
  bool color_;
  ImagePreparation preparation_;
  cv::Size raw_size_;
  GrayLevels levels_;
  size_t next_ = 0;
};

}  // namespace

std::vector<RecordedFrame> FramesOf(const std::vector<StampedName>& list,
                                    const std::string& folder) {
  const auto first_good = std::find_if(
      list.begin(), list.end(), [](const StampedName& item) { return item.problem.empty(); });
  if (first_good == list.end()) ThrowInput(list.front().problem + " (and so are all other lines)");
  const ListOrder order = OrderOf(list);
  if (order.parts() > 1) {
    LogWarning("the time stamps of " + folder + " go back " + std::to_string(order.parts() - 1) +
               (order.parts() == 2 ? " time" : " times") +
               " by more than a second: each is treated as a cut to another recording");
  }
  if (order.sorted) {
    LogWarning("the time stamps of " + folder +
               " are not in order; the frames were sorted by time");
  }
  std::vector<RecordedFrame> frames;
  for (const size_t i : order.order) {
    const StampedName& item = list[i];
    frames.push_back({order.times[i],
                      item.stamp,
                      folder + "/" + item.name,
                      {},
                      {},
                      item.problem,
                      order.part[i]});
  }
  const RecordedFrame* before = nullptr;
  for (RecordedFrame& frame : frames) {
    if (!frame.problem.empty()) continue;
    if (before && frame.part == before->part && frame.time <= before->time) {
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
  for (const StampedName& item : list) {
    if (!item.problem.empty()) LogWarning(item.problem + "; this line is ignored");
  }
  const ListOrder order = OrderOf(list);
  const int parts = frames.empty() ? 0 : frames.back().part + 1;
  const bool by_part = parts == order.parts();
  // AssociateByTime() never pairs a NaN.
  const double never = std::numeric_limits<double>::quiet_NaN();
  int found = 0;
  for (int part = 0; part < (by_part ? parts : 1); ++part) {
    std::vector<double> frame_times, list_times;
    for (const RecordedFrame& frame : frames) {
      const bool use = frame.problem.empty() && (!by_part || frame.part == part);
      frame_times.push_back(use ? frame.time : never);
    }
    for (size_t i = 0; i < list.size(); ++i) {
      const bool use = list[i].problem.empty() && (!by_part || order.part[i] == part);
      list_times.push_back(use ? list[i].time : never);
    }
    const auto pairs = AssociateByTime(frame_times, list_times, max_dt);
    for (const auto& [frame, item] : pairs) {
      frames[static_cast<size_t>(frame)].*which =
          folder + "/" + list[static_cast<size_t>(item)].name;
    }
    found += static_cast<int>(pairs.size());
  }
  return found;
}

std::optional<double> RateOf(const Recording& recording) {
  std::vector<double> steps;
  const RecordedFrame* before = nullptr;
  for (const RecordedFrame& frame : recording.frames) {
    if (!frame.problem.empty()) continue;
    if (before && before->part == frame.part && frame.time > before->time)
      steps.push_back(frame.time - before->time);
    before = &frame;
  }
  if (steps.empty()) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return 1 / *middle;
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
