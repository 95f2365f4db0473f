#include "fuzz/use_calibration.h"

#include <cmath>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/features/frame.h"
#include "alidade/map/map_file.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {
namespace {

constexpr int kWidth = 20, kHeight = 16;

void Shrink(RawCamera& raw) {
  if (raw.width * raw.height <= kWidth * kHeight) return;
  const double wide = 1.0 * kWidth / raw.width, high = 1.0 * kHeight / raw.height;
  raw.width = kWidth;
  raw.height = kHeight;
  raw.fx *= wide;
  raw.cx *= wide;
  raw.fy *= high;
  raw.cy *= high;
}

void PlaceKeypoints(const Camera& camera) {
  std::vector<Keypoint> keypoints;
  for (int y = 0; y < camera.height; y += 5) {
    for (int x = 0; x < camera.width; x += 5) {
      const Eigen::Vector2d ideal = camera.Undistort(Eigen::Vector2d(x, y));
      Expect(ideal.allFinite(), "a keypoint is nowhere");
      Keypoint keypoint;
      keypoint.x = static_cast<float>(ideal.x());
      keypoint.y = static_cast<float>(ideal.y());
      keypoints.push_back(keypoint);
    }
  }
  const KeypointGrid grid(keypoints, camera.width, camera.height);
  size_t found = 0;
  for (const Keypoint& k : keypoints) grid.VisitNear(k.x, k.y, 1, [&](int) { ++found; });
  Expect(found >= keypoints.size(), "the grid has lost a keypoint");
}

// A camera that is accepted for mapping must be accepted for saving.
void Save(const Camera& camera, Sensor sensor) {
  SavedMap saved;
  saved.camera = camera;
  saved.sensor = NameOf(sensor);
  DecodeMap(EncodeMap(saved));
}

}  // namespace

void UseCalibration(Calibration calibration) {
  if (calibration.right && calibration.right->width == calibration.left.width &&
      calibration.right->height == calibration.left.height)
    Shrink(*calibration.right);
  Shrink(calibration.left);
  std::optional<Error> refusal;
  bool any = false;
  for (const Sensor sensor : {Sensor::kMono, Sensor::kStereo, Sensor::kRgbd}) {
    std::optional<ImagePreparation> preparation;
    try {
      preparation.emplace(calibration, sensor);
    } catch (const Error& error) {
      refusal = error;
      continue;
    }
    any = true;
    const Camera& camera = preparation->camera();
    const cv::Mat raw(calibration.left.height, calibration.left.width, CV_8UC1, cv::Scalar(9));
    const cv::Size size(camera.width, camera.height);
    Expect(preparation->Left(raw).size() == size && preparation->Right(raw).size() == size &&
               preparation->Depth(raw).size() == size,
           "a picture has not the camera's size");
    Expect(preparation->R_camera_rectified().allFinite(), "a rotation is not finite");
    PlaceKeypoints(camera);
    if (sensor == Sensor::kRgbd) continue;  // treated as a monocular camera
    try {
      Save(camera, sensor);
    } catch (const Error& error) {
      Expect(false, std::string("a camera that maps cannot be saved: ") + error.what());
    }
  }
  if (!any) throw Error(*refusal);
}

}  // namespace alidade::fuzz
