#include "alidade/run/sources/any_source.h"

#include "alidade/base/error.h"
#include "alidade/io/camera/camera_request.h"
#include "alidade/io/camera/camera_source.h"
#include "alidade/io/camera/stream_device.h"
#include "alidade/io/files/file.h"
#include "alidade/io/ros/live/live_source.h"
#include "alidade/run/sources/synth_source.h"

namespace alidade {

std::unique_ptr<FrameSource> OpenAnySource(const std::string& source,
                                           const SourceOptions& options) {
  if (IsSynthSource(source)) {
    if (options.imu && options.imu != kNoImu)
      ThrowUsage("--imu FILE needs a recording; a rendered scene has readings with ?imu=phone");
    return OpenSynthSource(source, options);
  }
  return OpenSource(source, options);
}

bool IsLiveSource(const std::string& source) {
  return IsCameraSource(source) || IsStreamSource(source) || IsRos2Source(source);
}

std::string SourceToShow(const std::string& source) {
  return IsStreamSource(source) ? AddressToShow(source) : source;
}

std::string PathOfSource(const std::string& source) {
  if (IsSynthSource(source) || IsLiveSource(source)) return {};
  return IsThere(source) ? source : source.substr(0, source.find('?'));
}

}  // namespace alidade
