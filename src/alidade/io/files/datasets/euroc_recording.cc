#include "alidade/io/files/datasets/euroc_recording.h"

#include <algorithm>

#include "alidade/base/log.h"
#include "alidade/io/files/euroc_calibration.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/imu_file.h"

namespace alidade {
namespace {

// Seconds. The cameras are triggered together; their stamps may differ by microseconds.
constexpr double kMaxPairDelay = 0.001;

std::string Mav0Of(const std::string& folder) {
  return IsFolder(folder + "/mav0") ? folder + "/mav0" : folder;
}

std::vector<StampedName> ListOf(const std::string& camera) {
  return ReadStampedList(camera + "/data.csv", StampUnit::kNanoseconds, true, FindUnit::kYes);
}

// Frames without a right image are kept; they have no stereo depth.
void AddRight(Recording& recording, const std::string& camera) {
  const int found = AttachByTime(recording.frames, &RecordedFrame::right, ListOf(camera),
                                 camera + "/data", kMaxPairDelay);
  const auto good = std::count_if(recording.frames.begin(), recording.frames.end(),
                                  [](const RecordedFrame& frame) { return frame.problem.empty(); });
  if (found < good) {
    LogWarning(std::to_string(good - found) + " of " + std::to_string(good) +
               " frames have no right image");
  }
  recording.has_right = found > 0;
}

Calibration CalibrationOf(const std::string& mav0, bool stereo) {
  const EurocCamera left = ReadEurocCamera(mav0 + "/cam0/sensor.yaml");
  Calibration calibration;
  calibration.origin = mav0 + "/cam0/sensor.yaml";
  calibration.left = left.raw;
  calibration.fps = left.fps;
  if (stereo) {
    const EurocCamera right = ReadEurocCamera(mav0 + "/cam1/sensor.yaml");
    calibration.right = right.raw;
    calibration.T_left_right = left.T_body_camera.Inverse() * right.T_body_camera;
  }
  return calibration;
}

}  // namespace

bool IsEurocFolder(const std::string& folder) { return IsThere(Mav0Of(folder) + "/cam0/data.csv"); }

Recording ReadEurocRecording(const std::string& folder, bool with_imu) {
  const std::string mav0 = Mav0Of(folder);
  Recording recording;
  recording.kind = "euroc";
  recording.frames = FramesOf(ListOf(mav0 + "/cam0"), mav0 + "/cam0/data");
  if (IsThere(mav0 + "/cam1/data.csv")) AddRight(recording, mav0 + "/cam1");
  if (IsThere(mav0 + "/cam0/sensor.yaml")) {
    recording.calibration =
        CalibrationOf(mav0, recording.has_right && IsThere(mav0 + "/cam1/sensor.yaml"));
  }
  if (with_imu && IsThere(mav0 + "/imu0/data.csv")) {
    std::optional<Se3> T_body_camera;
    if (recording.calibration)
      T_body_camera = ReadEurocCamera(mav0 + "/cam0/sensor.yaml").T_body_camera;
    recording.imu = ReadEurocImu(mav0 + "/imu0", T_body_camera);
  }
  return recording;
}

}  // namespace alidade
