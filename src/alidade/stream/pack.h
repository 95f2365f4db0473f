// Packs the values of the stream into bytes and unpacks them (stream.fbs defines the encodings).
// Little-endian, as all supported machines are.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/geometry/camera.h"
#include "alidade/map/depth_map.h"
#include "alidade/stream/stream_generated.h"
#include "alidade/stream/told_map.h"
#include "alidade/system/slam.h"

namespace alidade {

stream::Pose PackPose(const Se3& pose);
Se3 UnpackPose(const stream::Pose& pose);  // normalizes the quaternion

// Position in the image along an axis of `size` pixels, clamped to it: pixel = value * size / 65536
// - 0.5.
uint16_t PackPlace(double pixel, int size);
double UnpackPlace(uint16_t value, int size);

inline constexpr size_t kPackedFeature = 6, kPackedLandmark = 20, kPackedPoint = 8;  // bytes

void PackFeature(const FeatureUse& feature, const Camera& camera, std::vector<uint8_t>& bytes);
void PackLandmark(LandmarkId id, const ToldLandmark& told, std::vector<uint8_t>& bytes);
std::pair<LandmarkId, ToldLandmark> UnpackLandmark(const uint8_t* bytes);

struct PackedCloud {
  float least = 0, most = 0;
  std::string bytes;
};
struct CloudPoint {
  double x = 0, y = 0;       // undistorted pixel
  double inverse_depth = 0;  // per unit, with lengths scaled as if the keyframe's scale were 1
  uint8_t red = 0, green = 0, blue = 0;
};
// Packs inverse depth logarithmically into 65536 steps from the smallest to the largest value. For
// a range of 1 to 1000 a step is 1e-4 of the depth; the standard deviation is at least 1e-3.
// Subsamples evenly to `most_points`.
PackedCloud PackCloud(const DepthMap& depth, int most_points);
// `width`, `height`: the camera's.
CloudPoint UnpackPoint(const uint8_t* bytes, float least, float most, int width, int height);

}  // namespace alidade
