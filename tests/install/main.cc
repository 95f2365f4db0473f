// What the README shows, and what else a program of its own needs: images in, a state out;
// recordings read, results judged, detectors opened, errors caught.
#include <alidade/slam.h>

#include <cstdio>
#include <fstream>
#include <string>

// All of the table in docs/reference/cpp.md.
#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/detect/detector.h"
#include "alidade/detect/onnx/open_detector.h"
#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/depth_error.h"
#include "alidade/evaluation/rpe.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/eigen_transforms.h"
#include "alidade/geometry/rectify.h"
#include "alidade/geometry/se3.h"
#include "alidade/geometry/sim3.h"
#include "alidade/io/cloud.h"
#include "alidade/io/colmap.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/open_source.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/frame_source.h"
#include "alidade/io/trajectory.h"
#include "alidade/map/keyframe.h"
#include "alidade/map/landmark.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_store.h"
#include "alidade/run/live/slam_view.h"
#include "alidade/system/merge_maps.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace {

int Fail(const char* what) {
  std::printf("outside: %s\n", what);
  return 1;
}

// 2 × 1 pixels of 24 bits: what only the media module reads.
void WriteBitmap(const std::string& path) {
  std::string bytes(54 + 8, '\0');
  bytes.replace(0, 2, "BM");
  bytes[2] = 62, bytes[10] = 54, bytes[14] = 40, bytes[18] = 2, bytes[22] = 1, bytes[26] = 1,
  bytes[28] = 24;
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) return Fail("needs a folder to write in");
  const std::string folder = arguments[1];
  if (std::string(ALIDADE_VERSION).empty() || ALIDADE_VERSION_MAJOR < 0) return Fail("no version");

  const auto camera = alidade::Camera::FromFieldOfView(640, 480, 66);
  alidade::SlamSettings settings;
  settings.Check();
  alidade::Slam slam(camera, settings);
  const cv::Mat black(480, 640, CV_8UC1, cv::Scalar(0));
  alidade::SlamView view(slam);
  view.Record(folder + "/seen");
  if (count > 2 && view.Serve().rfind("http://127.0.0.1:", 0) != 0) return Fail("no viewer");
  const alidade::FrameInput input = {.time = 0.5, .image = black};
  const alidade::TrackResult result = slam.Track(input);
  view.Show(input, result);
  view.Finished();
  if (!std::ifstream(folder + "/seen/run.stream")) return Fail("nothing was recorded");
  if (result.state != alidade::TrackState::kInitializing) return Fail("black is no start");
  try {
    slam.Track({.time = 0.5, .image = black});
    return Fail("the same time twice was taken");
  } catch (const alidade::Error& error) {
    if (error.kind() != alidade::ErrorKind::kInput) return Fail("wrong kind of error");
  }
  // Values with Eigen inside, made there and read here: both must mean the same bytes.
  if (!result.quality.covariance.isZero() ||
      !alidade::Se3::Exp(alidade::Vector6d::Ones()).R.isUnitary(1e-9)) {
    return Fail("matrices are laid out otherwise in the library");
  }

  const alidade::Se3 pose = alidade::Se3::Exp(alidade::Vector6d::Ones());
  if (!alidade::FromMatrix(alidade::ToIsometry(pose).matrix()).R.isApprox(pose.R))
    return Fail("a pose as a matrix");

  const std::string path = folder + "/trajectory.txt";
  std::ofstream(path) << "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 1 0 0 0 0 1\n4 1 1 1 0 0 0 1\n";
  const alidade::Trajectory truth = alidade::ReadTrajectory(path);
  if (alidade::EvaluateAte(truth, truth, {}).error.rmse > 1e-9)
    return Fail("ATE of the truth itself");

  WriteBitmap(folder + "/000.bmp");
  if (alidade::ReadImageGray(folder + "/000.bmp").cols != 2) return Fail("a bitmap of two pixels");
  try {
    alidade::OpenSource(folder + "/none");
    return Fail("a recording that is not there was opened");
  } catch (const alidade::Error&) {
  }
  try {
    alidade::OpenDetector(path);
    return Fail("a text was taken for a detector");
  } catch (const alidade::Error&) {
  }
  std::printf("%d keyframes\n", slam.Snapshot().keyframe_count());
  return 0;
}
