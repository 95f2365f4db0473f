#include "alidade/map/map_decode_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/map/map_generated.h"

namespace alidade {
namespace {

constexpr int kMaxImageSide = 1 << 15;      // pixels
constexpr int64_t kMaxImageArea = 1 << 27;  // pixels
constexpr float kMaxPixel = 1e9f;           // undistorted positions may lie far outside the image
// A year at 30 frames/s; leaves room to continue counting within an int.
constexpr int kMaxFrameNumber = 1 << 30;
constexpr float kMaxAngle = 3.2f;  // π plus rounding

Keypoint DecodeKeypoint(const fb::Keypoint& from) {
  const Keypoint keypoint{from.x(),        from.y(),       from.raw_x(), from.raw_y(), from.angle(),
                          from.response(), from.right_x(), from.depth(), from.level()};
  const auto near = [](float v, float most) { return v >= -most && v <= most; };  // false for NaN
  Require(near(keypoint.x, kMaxPixel) && near(keypoint.y, kMaxPixel) &&
              near(keypoint.raw_x, kMaxPixel) && near(keypoint.raw_y, kMaxPixel) &&
              near(keypoint.right_x, kMaxPixel) && near(keypoint.angle, kMaxAngle) &&
              std::isfinite(keypoint.response) && std::isfinite(keypoint.depth),
          "a keypoint has an impossible value");
  Require(keypoint.level >= 0 && keypoint.level < kPyramidLevels,
          "a keypoint is on no pyramid level");
  return keypoint;
}

// The verifier guarantees alignment to 4 bytes, but 8-byte numbers need alignment to 8.
template <typename Items>
void RequireAligned(const Items* items) {
  const auto place = items == nullptr ? 0 : reinterpret_cast<uintptr_t>(items->Data());
  Require(SizeOf(items) == 0 || place % sizeof(uint64_t) == 0, "a list is misaligned");
}

constexpr const char* kFarPoint = "a point is not a number, or impossibly far away";

bool IsNear(const Eigen::Vector3d& p) {  // false for NaN
  return p.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthest;
}

Eigen::Vector3d DecodePoint(const fb::Vec3& from) {
  const Eigen::Vector3d p = PointOf(from);
  Require(IsNear(p), kFarPoint);
  return p;
}

}  // namespace

void Require(bool holds, const char* what) {
  if (!holds) ThrowInput(std::string("the map contradicts itself: ") + what);
}

Eigen::Vector3d PointOf(const fb::Vec3& from) { return {from.x(), from.y(), from.z()}; }

const char* ComplaintOf(const Landmark& landmark) {
  // Conditions are written so that NaN fails them.
  if (!IsNear(landmark.p_world)) return kFarPoint;
  if (!(landmark.normal.norm() <= 1.001f)) return "a landmark's normal is not a direction";
  if (!(landmark.min_distance >= 0 && landmark.min_distance <= landmark.max_distance &&
        landmark.max_distance <= kFarthest))
    return "a landmark has an empty range of distances";
  if (!(landmark.static_probability >= 0 && landmark.static_probability <= 1))
    return "a landmark's static probability is not in [0, 1]";
  return nullptr;
}

Se3 DecodePose(const fb::Pose* from) {
  Require(from, "a keyframe has no pose");
  Se3 T;
  T.R.row(0) = DecodePoint(from->row0()).transpose();
  T.R.row(1) = DecodePoint(from->row1()).transpose();
  T.R.row(2) = DecodePoint(from->row2()).transpose();
  T.t = DecodePoint(from->t());
  const Eigen::Matrix3d error = T.R * T.R.transpose() - Eigen::Matrix3d::Identity();
  Require(error.cwiseAbs().maxCoeff() < 1e-6 && T.R.determinant() > 0,
          "a pose is not a rigid motion");
  return T;
}

double DecodeScale(double from) {
  constexpr double kMost = 1e6;  // far beyond any loop correction
  Require(from >= 1 / kMost && from <= kMost, "a keyframe has an impossible scale");
  return from;
}

Descriptor DecodeDescriptor(const fb::Descriptor& from) {
  return {{from.word0(), from.word1(), from.word2(), from.word3()}};
}

Camera DecodeCamera(const fb::Camera& from) {
  Camera camera;
  camera.width = from.width();
  camera.height = from.height();
  camera.fx = from.fx();
  camera.fy = from.fy();
  camera.cx = from.cx();
  camera.cy = from.cy();
  Require(SizeOf(from.distortion()) == camera.distortion.size(),
          "the camera's distortion has not 5 numbers");
  RequireAligned(from.distortion());
  for (size_t i = 0; i < camera.distortion.size(); ++i) {
    camera.distortion[i] = from.distortion()->Get(static_cast<uint32_t>(i));
  }
  camera.fps = from.fps();
  camera.depth_factor = from.depth_factor();
  camera.baseline = from.baseline();
  camera.readout = {from.readout_x(), from.readout_y()};
  camera.focal_sigma = from.focal_sigma();
  Require(camera.focal_sigma >= 0 && camera.focal_sigma <= 1e3,
          "the camera's focal_sigma is impossible");
  camera.Check();
  Require(camera.width <= kMaxImageSide && camera.height <= kMaxImageSide &&
              int64_t{camera.width} * camera.height <= kMaxImageArea,
          "the camera's image is impossibly large");
  return camera;
}

std::shared_ptr<const Frame> DecodeFrame(const fb::KeyFrame& from, const Camera& camera,
                                         ByteBudget& budget) {
  const size_t count = SizeOf(from.keypoints());
  Require(SizeOf(from.descriptors()) == count, "keypoints and descriptors differ in number");
  budget.Take(count, sizeof(fb::Keypoint) + sizeof(fb::Descriptor));
  RequireAligned(from.descriptors());
  auto frame = std::make_shared<Frame>();
  frame->number = from.frame();
  frame->time = from.time();
  Require(frame->number >= 0 && frame->number <= kMaxFrameNumber,
          "a keyframe's frame has an impossible number");
  Require(std::isfinite(frame->time), "a keyframe's time is not a number");
  frame->keypoints.reserve(count);
  frame->descriptors.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    frame->keypoints.push_back(DecodeKeypoint(*from.keypoints()->Get(i)));
    frame->descriptors.push_back(DecodeDescriptor(*from.descriptors()->Get(i)));
  }
  if (count > 0) frame->grid = KeypointGrid(frame->keypoints, camera.width, camera.height);
  return frame;
}

SavedPlaces DecodePlaces(const fb::Places* from, ByteBudget& budget) {
  SavedPlaces places;
  if (!from) return places;
  const size_t count = SizeOf(from->nodes());
  Require(count <= Vocabulary::kMaxNodes, "its vocabulary is impossibly large");
  budget.Take(count, sizeof(fb::PlaceNode));
  RequireAligned(from->nodes());
  places.nodes.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    const fb::PlaceNode& node = *from->nodes()->Get(i);
    places.nodes.push_back({DecodeDescriptor(node.centre()), node.first_child(), node.children()});
  }
  places.grown_at = from->grown_at();
  Require(places.nodes.empty() == (places.grown_at == 0), "its vocabulary is missing or empty");
  Vocabulary checked(places.nodes);  // throws if the nodes are not a tree
  return places;
}

}  // namespace alidade
