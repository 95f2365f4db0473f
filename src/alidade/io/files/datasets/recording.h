// A recording on disk: a list of image files with times. Every dataset reader fills a `Recording`;
// PlayRecording() plays all of them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/calibration.h"
#include "alidade/io/files/datasets/stamped_list.h"
#include "alidade/io/frame_source.h"
#include "alidade/io/wrappers.h"

namespace alidade {

struct RecordedFrame {
  double time = 0;      // seconds
  std::string stamp;    // time as written
  std::string image;    // path
  std::string right;    // path; empty: none for this frame
  std::string depth;    // path; empty: none for this frame
  std::string problem;  // why the frame must not be used; empty: no problem
  int part = 0;         // see SourceFrame
};

struct Recording {
  std::string name, kind;       // see SourceInfo
  std::string lens_told, told;  // see SourceInfo
  std::vector<RecordedFrame> frames;
  bool has_right = false, has_depth = false;
  bool color = false;                      // read the frames' colors as well
  std::optional<Calibration> calibration;  // found beside the images
  // Of the (left) camera as mounted; a calibration with a sensor of its own replaces the model.
  std::optional<ImuRecording> imu;
  double default_depth_factor = 0;  // used when the calibration has none
  bool depth_assumed = false;       // it was
  bool fps_assumed = false;         // see SourceInfo
};

// Frames from a list of images in `folder`, in order of time. Entries up to a second out of order
// are sorted. A larger step back begins another part (SourceFrame::part): two recordings in one
// list. A list with more than a tenth of such steps has no order, and is sorted as a whole. Each of
// these is told as a warning. A frame with the time of its predecessor gets a problem. Throws Error
// (input) when no line is usable.
std::vector<RecordedFrame> FramesOf(const std::vector<StampedName>& list,
                                    const std::string& folder);

// Assigns to each good frame the item of `list` nearest in time (less than `max_dt` seconds away,
// each item at most once) as its `right` or `depth`; within parts, when the list has as many as the
// frames. Returns how many frames got one. Warns of items with a problem and skips them.
int AttachByTime(std::vector<RecordedFrame>& frames, std::string RecordedFrame::*which,
                 const std::vector<StampedName>& list, const std::string& folder, double max_dt);

// Size of the first image whose header can be read. Throws Error (input) when there is none.
cv::Size SizeOfImages(const Recording& recording);

// Frames per second: 1 / the median step of the frames' times; nullopt: there are no two frames of
// one part.
std::optional<double> RateOf(const Recording& recording);

// `preparation` must be made for `sensor`. A frame whose image does not have size `raw_size` gets a
// problem.
std::unique_ptr<FrameSource> PlayRecording(Recording recording, Sensor sensor,
                                           ImagePreparation preparation, cv::Size raw_size,
                                           bool camera_guessed);

}  // namespace alidade
