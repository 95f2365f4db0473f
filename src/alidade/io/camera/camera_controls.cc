#include "alidade/io/camera/camera_controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/print.h"

namespace alidade {
namespace {

constexpr double kExposureUnit = 1e-4;  // seconds of V4L2_CID_EXPOSURE_ABSOLUTE

struct Range {
  int least = 0, most = 0, step = 1;
};

// nullopt: the camera does not have this control, or it is switched off for good.
std::optional<Range> RangeOf(const DeviceFile& file, uint32_t control) {
  v4l2_queryctrl query{};
  query.id = control;
  if (file.Ask(VIDIOC_QUERYCTRL, &query) != 0) return std::nullopt;
  if ((query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY)) != 0)
    return std::nullopt;
  return Range{query.minimum, query.maximum, std::max(1, query.step)};
}

std::string Milliseconds(double seconds) {
  char text[40];
  PrintTo(text, sizeof text, "%.4g ms", 1e3 * seconds);
  return text;
}

}  // namespace

std::vector<std::string> ControlsOf(const DeviceFile& file) {
  std::vector<std::string> controls;
  if (const auto range = RangeOf(file, V4L2_CID_EXPOSURE_ABSOLUTE))
    controls.push_back("exposure " + Milliseconds(range->least * kExposureUnit) + " to " +
                       Milliseconds(range->most * kExposureUnit));
  const bool automatic = RangeOf(file, V4L2_CID_FOCUS_AUTO).has_value();
  if (const auto range = RangeOf(file, V4L2_CID_FOCUS_ABSOLUTE))
    controls.push_back("focus " + std::to_string(range->least) + " to " +
                       std::to_string(range->most) + (automatic ? ", automatic" : ""));
  return controls;
}

CameraControls::CameraControls(const DeviceFile& file, const CameraRequest& request) : file_(file) {
  if (request.exposure) {
    const auto range = RangeOf(file_, V4L2_CID_EXPOSURE_ABSOLUTE);
    if (!range) ThrowUsage(request.device + ": its exposure cannot be set");
    const double wanted = *request.exposure / kExposureUnit;
    if (wanted < range->least - 0.5 || wanted > range->most + 0.5)
      ThrowUsage(request.device + ": exposures are " + Milliseconds(range->least * kExposureUnit) +
                 " to " + Milliseconds(range->most * kExposureUnit));
    Set(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
    const int value = static_cast<int>(std::lround(wanted));
    if (!Set(V4L2_CID_EXPOSURE_ABSOLUTE, value))
      ThrowUsage(request.device + ": the exposure was refused");
    Tell("exposure " + Milliseconds(value * kExposureUnit));
  } else {
    // A long exposure in the dark would lower the rate and blur the images.
    Set(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0);
  }
  // A lens that moves changes the camera's calibration.
  const bool held = Set(V4L2_CID_FOCUS_AUTO, 0);
  if (request.focus) {
    if (!Set(V4L2_CID_FOCUS_ABSOLUTE, *request.focus))
      ThrowUsage(request.device + ": focus " + std::to_string(*request.focus) + " was refused");
    Tell("focus " + std::to_string(*request.focus));
  } else if (held) {
    Tell("focus held");
  }
}

CameraControls::~CameraControls() {
  for (auto control = before_.rbegin(); control != before_.rend(); ++control) {
    v4l2_control value{control->first, control->second};
    file_.Ask(VIDIOC_S_CTRL, &value);
  }
}

// Returns false if the camera does not have the control, or refuses the value.
bool CameraControls::Set(uint32_t control, int value) {
  if (!RangeOf(file_, control)) return false;
  v4l2_control now{control, 0};
  const bool known = file_.Ask(VIDIOC_G_CTRL, &now) == 0;
  if (known && now.value == value) return true;
  v4l2_control wanted{control, value};
  if (file_.Ask(VIDIOC_S_CTRL, &wanted) != 0) return false;
  if (known) before_.emplace_back(control, now.value);
  return true;
}

void CameraControls::Tell(const std::string& text) { told_ += (told_.empty() ? "" : ", ") + text; }

}  // namespace alidade
