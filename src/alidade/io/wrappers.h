// Frame sources that wrap another source: a clip of it, repeated playback, or its frames with
// inertial readings. See also read_ahead.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"

namespace alidade {

// Frames `first` to `last`, both included; `last` -1: to the end. Throws Error: kUsage for a
// negative or reversed range, kInput when `first` is past the end.
std::unique_ptr<FrameSource> Clip(std::unique_ptr<FrameSource> source, int first, int last);

// Plays a recording forwards and backwards `times` times; 0 returns `source` unchanged. The frame
// at a turning point is returned once. Frame numbers and times keep increasing: backwards, the
// intervals between frames are those of the forward pass. After the first pass the stamps are
// generated from the times. Inertial readings are left out: played backward, a gyroscope's bias
// would change its sign. Throws Error (usage) when `source` cannot seek.
std::unique_ptr<FrameSource> Repeat(std::unique_ptr<FrameSource> source, int times);

// The inertial readings of a recording.
struct ImuRecording {
  ImuModel model;
  std::vector<ImuSample> samples;  // in order of time
};

// The first frame, and one after a seek, gets the readings from this long before it on; readings
// run ahead of each image by as much, seconds. Time offsets of phones are up to 0.05 s.
inline constexpr double kImuAround = 0.1;

// Gives each frame the readings since the frame before it (SourceFrame::imu). A source without
// readings of its own; `imu.model` becomes that of SourceInfo, so its T_camera_imu is of the
// rectified camera. `told` is added to SourceInfo::told. Warns when the first
// image is of another time than all readings.
std::unique_ptr<FrameSource> WithImu(std::unique_ptr<FrameSource> source, ImuRecording imu,
                                     const std::string& told = {});

}  // namespace alidade
