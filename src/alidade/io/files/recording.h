// A recording on disk: which image was taken when. Every dataset reader makes one of these; one
// player plays them all.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/io/calibration.h"
#include "alidade/io/files/stamped_list.h"
#include "alidade/io/frame_source.h"

namespace alidade {

struct RecordedFrame {
  double time = 0;      // seconds
  std::string stamp;    // as written
  std::string image;    // path
  std::string right;    // path; empty: none for this frame
  std::string depth;    // path; empty: none for this frame
  std::string problem;  // not empty: not to be used, and why
};

struct Recording {
  std::string name, kind;  // as in SourceInfo
  std::string lens_told;   // likewise
  std::vector<RecordedFrame> frames;
  bool has_right = false, has_depth = false;
  bool color = false;                      // frames are to have their colours as well
  std::optional<Calibration> calibration;  // as found beside the images
  double default_depth_factor = 0;         // for calibrations that don't say
};

// Frames from a list of images in `folder`, in the order of time (stable; says so when that was not
// the list's), with a problem where a time repeats.
std::vector<RecordedFrame> FramesOf(const std::vector<StampedName>& list,
                                    const std::string& folder);

// Gives each good frame the item of `list` nearest in time (under `max_dt` seconds away, one to
// one) as its `right` or `depth`; returns how many frames got one. Items with a problem are left
// out with a warning.
int AttachByTime(std::vector<RecordedFrame>& frames, std::string RecordedFrame::*which,
                 const std::vector<StampedName>& list, const std::string& folder, double max_dt);

// Of the first image whose header can be read; throws Error when there is none.
cv::Size SizeOfImages(const Recording& recording);

// `preparation` must be made for `sensor`. Images of other sizes than `raw_size` are problems.
std::unique_ptr<FrameSource> PlayRecording(Recording recording, Sensor sensor,
                                           ImagePreparation preparation, cv::Size raw_size,
                                           bool camera_guessed);

}  // namespace alidade
