// Live cameras and network streams as sources of frames.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

// "rtsp://…" and other addresses that libavformat opens: rtsps, http, https, rtmp, srt, udp.
bool IsStreamSource(const std::string& source);

// A camera of this machine: see IsCameraSource(). Times are seconds since the first image, by the
// kernel's time stamps. With `stereo`, the halves of an image are a pair and need a calibration of
// two cameras. A camera that was unplugged is awaited; it may come back under another number.
// Throws Error: usage for options that do not fit, input if it cannot be opened.
std::unique_ptr<FrameSource> OpenCameraSource(const std::string& source,
                                              const SourceOptions& options);

// One camera behind an address. Times are those of the stream, or of arrival with http, seconds
// since the first image. A connection that ended is opened again. Throws as OpenCameraSource().
std::unique_ptr<FrameSource> OpenStreamSource(const std::string& address,
                                              const SourceOptions& options);

}  // namespace alidade
