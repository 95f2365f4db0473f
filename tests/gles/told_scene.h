// Scenes from handwritten stream messages, read by the stream's own reader.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/stream/pack.h"
#include "alidade/stream/stream_generated.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gles_test {

struct ToldPoint {
  // In the keyframe, with lengths scaled as if its scale were 1.
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  int red = 0, green = 0, blue = 0;
};
struct ToldFeature {
  double x = 0, y = 0;  // pixels
  stream::Use use = stream::Use::matched;
};

// Content of one map message.
struct Change {
  struct NewKeyFrame {
    uint32_t id = 0, map = 0;
    Se3 T_world_camera;
    double scale = 1;
  };
  struct NewLandmark {
    uint32_t id = 0, keyframe = 0;
    Eigen::Vector3f p = Eigen::Vector3f::Zero();
  };
  struct NewCloud {
    uint32_t keyframe = 0;
    std::vector<ToldPoint> points;
  };
  struct Cull {
    uint32_t id = 0, follows = 0;
    double scale = 1;
    Se3 T_follows_culled;
  };
  bool whole = false;
  std::vector<NewKeyFrame> keyframes, moves;
  std::vector<NewLandmark> landmarks;
  std::vector<uint32_t> removed;
  std::vector<Cull> culled;
  std::vector<NewCloud> clouds;
};

// The semi-dense points of a keyframe in the world, unpacked by the stream's own code.
inline std::vector<Eigen::Vector3d> KeptPoints(const StreamScene& scene, uint32_t keyframe) {
  const SceneKeyFrame& k = scene.keyframes.at({keyframe});
  std::vector<Eigen::Vector3d> points;
  for (size_t at = 0; at < k.depth.size(); at += kPackedPoint) {
    const CloudPoint point =
        UnpackPoint(reinterpret_cast<const uint8_t*>(&k.depth[at]), k.depth_least, k.depth_most,
                    scene.camera.width, scene.camera.height);
    const Eigen::Vector3d p = scene.camera.Unproject({point.x, point.y}, 1 / point.inverse_depth);
    points.push_back(k.T_world_camera * (k.scale * p));
  }
  return points;
}

class Teller {
 public:
  explicit Teller(const Camera& camera) : camera_(camera) {
    const auto told = stream::CreateCamera(builder_, static_cast<uint16_t>(camera.width),
                                           static_cast<uint16_t>(camera.height), camera.fx,
                                           camera.fy, camera.cx, camera.cy);
    stream::HelloBuilder hello(builder_);
    hello.add_camera(told);
    Take(stream::Body::Hello, hello.Finish().Union());
  }

  void Tell(const Change& change) {
    std::vector<flatbuffers::Offset<stream::KeyFrame>> keyframes;
    for (const Change::NewKeyFrame& k : change.keyframes) {
      const stream::Pose pose = PackPose(k.T_world_camera);
      keyframes.push_back(
          stream::CreateKeyFrame(builder_, k.id, k.map, KeyFrameId::kNone, 0, 0, &pose, k.scale));
    }
    std::vector<stream::Move> moves;
    for (const Change::NewKeyFrame& k : change.moves)
      moves.emplace_back(k.id, k.scale, PackPose(k.T_world_camera));
    std::vector<uint8_t> landmarks;
    for (const Change::NewLandmark& l : change.landmarks)
      PackLandmark({l.id}, {{l.keyframe}, l.p}, landmarks);
    std::vector<stream::Culled> culled;
    for (const Change::Cull& c : change.culled)
      culled.emplace_back(c.id, c.follows, c.scale, PackPose(c.T_follows_culled));
    std::vector<flatbuffers::Offset<stream::DepthCloud>> clouds;
    for (const Change::NewCloud& cloud : change.clouds) {
      const PackedCloud packed = Pack(cloud.points);
      const auto bytes = builder_.CreateVector(
          reinterpret_cast<const uint8_t*>(packed.bytes.data()), packed.bytes.size());
      clouds.push_back(
          stream::CreateDepthCloud(builder_, cloud.keyframe, packed.least, packed.most, bytes));
    }
    const auto told_keyframes = builder_.CreateVector(keyframes);
    const auto told_moves = builder_.CreateVectorOfStructs(moves);
    const auto told_landmarks = builder_.CreateVector(landmarks);
    const auto removed = builder_.CreateVector(change.removed);
    const auto told_culled = builder_.CreateVectorOfStructs(culled);
    const auto told_clouds = builder_.CreateVector(clouds);
    stream::MapChangeBuilder message(builder_);
    message.add_version(++version_);
    message.add_whole(change.whole);
    message.add_keyframes(told_keyframes);
    message.add_moves(told_moves);
    message.add_landmarks(told_landmarks);
    message.add_removed_landmarks(removed);
    message.add_culled(told_culled);
    message.add_depth(told_clouds);
    Take(stream::Body::MapChange, message.Finish().Union());
  }

  // A frame with its pose relative to a keyframe (lengths scaled as if its scale were 1). kNone:
  // lost, with `guess` as the predicted pose.
  void TellFrame(uint32_t reference, const Se3& T_reference_camera,
                 const std::vector<ToldFeature>& features = {}, const Se3* guess = nullptr) {
    std::vector<uint8_t> packed;
    for (const ToldFeature& feature : features) {
      FeatureUse use;
      use.x = static_cast<float>(feature.x);
      use.y = static_cast<float>(feature.y);
      use.fresh = feature.use == stream::Use::fresh;
      use.matched = feature.use == stream::Use::matched;
      use.static_probability = feature.use == stream::Use::moving ? 0.f : 1.f;
      PackFeature(use, camera_, packed);
    }
    const auto bytes = builder_.CreateVector(packed);
    const bool tracked = reference != KeyFrameId::kNone;
    const stream::Pose pose = PackPose(T_reference_camera);
    const stream::Pose in_world = PackPose(guess ? *guess : Se3());
    stream::FrameBuilder frame(builder_);
    frame.add_number(number_++);
    frame.add_state(tracked ? stream::State::tracking : stream::State::lost);
    frame.add_reference(reference);
    if (tracked) frame.add_t_reference_camera(&pose);
    if (guess || tracked) frame.add_t_world_camera(&in_world);
    frame.add_predicted(guess != nullptr);
    frame.add_features(bytes);
    Take(stream::Body::Frame, frame.Finish().Union());
  }

  StreamScene scene;
  std::vector<std::string> messages;  // all messages so far

 private:
  PackedCloud Pack(const std::vector<ToldPoint>& points) const {
    DepthMap depth;
    depth.width = camera_.width;
    depth.height = camera_.height;
    depth.scale = 1;
    for (const ToldPoint& point : points) {
      const Eigen::Vector2d pixel = camera_.Project(point.p);
      DepthPixel told;
      told.x = static_cast<uint16_t>(std::lround(pixel.x()));
      told.y = static_cast<uint16_t>(std::lround(pixel.y()));
      told.inverse_depth = static_cast<float>(1 / point.p.z());
      told.rgb = {static_cast<uint8_t>(point.red), static_cast<uint8_t>(point.green),
                  static_cast<uint8_t>(point.blue)};
      depth.pixels.push_back(told);
    }
    return PackCloud(depth, static_cast<int>(points.size()));
  }

  void Take(stream::Body kind, flatbuffers::Offset<void> body) {
    builder_.Finish(stream::CreateMessage(builder_, kind, body), stream::MessageIdentifier());
    messages.emplace_back(reinterpret_cast<const char*>(builder_.GetBufferPointer()),
                          builder_.GetSize());
    scene.Take(messages.back());
    builder_.Clear();
  }

  Camera camera_;
  flatbuffers::FlatBufferBuilder builder_;
  uint64_t version_ = 0;
  int number_ = 0;
};

}  // namespace alidade::gles_test
