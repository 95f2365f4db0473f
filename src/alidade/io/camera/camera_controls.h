// Exposure and focus of a camera, held while it is open.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "alidade/io/camera/camera_request.h"
#include "alidade/io/camera/device_file.h"

namespace alidade {

// What can be set, for users: "exposure 0.1 to 500 ms, automatic". Throws nothing.
std::vector<std::string> ControlsOf(const DeviceFile& file);

class CameraControls {
 public:
  // Sets what the request wants. Throws Error (usage) if the camera cannot do that. `file` must
  // outlive this object, which sets everything back when it is destroyed.
  CameraControls(const DeviceFile& file, const CameraRequest& request);
  ~CameraControls();
  CameraControls(const CameraControls&) = delete;
  CameraControls& operator=(const CameraControls&) = delete;

  // What was set, for users: "exposure 8 ms, focus held".
  const std::string& told() const { return told_; }

 private:
  bool Set(uint32_t control, int value);
  void Tell(const std::string& text);

  const DeviceFile& file_;
  std::vector<std::pair<uint32_t, int>> before_;  // values to set back, in order
  std::string told_;
};

}  // namespace alidade
