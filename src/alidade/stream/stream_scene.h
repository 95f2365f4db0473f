// State of a receiver of the stream, assembled from its messages. The C++ counterpart of web/scene,
// for tests and native drawing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/io/cloud.h"
#include "alidade/map/map_world.h"
#include "alidade/tracking/track_failure.h"

namespace alidade {

struct SceneKeyFrame {
  MapId map;
  KeyFrameId parent;
  int number = 0;   // of its frame
  double time = 0;  // seconds
  Se3 T_world_camera;
  double scale = 1;
  std::vector<uint32_t> covisible, loops;
  float depth_least = 0, depth_most = 0;
  std::string depth;        // packed points (pack.h)
  uint64_t depth_told = 0;  // StreamScene::told at the last update of `depth`; 0: none
};

// Relative to its keyframe: p_world = T_world_camera * (scale * p).
struct SceneLandmark {
  KeyFrameId keyframe;
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
};

struct SceneFrame {
  int number = 0;
  int state = 0;  // TrackState
  double time = 0;
  KeyFrameId reference;  // invalid: no pose
  Se3 T_reference_camera;
};

// A feature of the last frame.
struct SceneFeature {
  double x = 0, y = 0;  // pixels
  int use = 0;          // stream::Use
};

// A detection; pixels, from edge to edge.
struct SceneBox {
  float x = 0, y = 0, width = 0, height = 0;
  float score = 0;
  std::string label;
};

struct SceneEvent {
  int kind = 0;  // stream::EventKind
  int number = 0;
  double time = 0;   // seconds
  bool bad = false;  // lost, cut, given up or warning
  std::string text;
};

// The last frame, as it was when processed.
struct SceneNow {
  int number = 0;
  int state = 0;                               // TrackState
  double time = 0;                             // seconds
  TrackFailure failure = TrackFailure::kNone;  // why there is no pose
  std::string reason;                          // in words; of old streams that have nothing else
  MapId map;                                   // invalid: no pose
  std::optional<Se3> T_world_camera;           // when tracked
  std::optional<Se3> T_world_guess;  // when recently lost: the pose predicted by the last motion
  uint32_t keyframes = 0, landmarks = 0, matches = 0, maps = 0;
  std::vector<float> ms;  // milliseconds of stream.fbs' stages; negative: did not run
  int picture_width = 0, picture_height = 0;
  std::string picture, picture_type;  // empty: none
};

class StreamScene {
 public:
  // Applies a message. Throws Error (input) for bytes that are not a message, or that refer to
  // unknown objects; part of the message may have been applied then.
  void Take(std::string_view message);

  int width = 0, height = 0;  // of the camera
  Camera camera;              // size, focal lengths, principal point, distortion and baseline
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();  // see SourceInfo
  std::string source, unit;  // unit: "m" or "map units"; see UnitOf()
  uint64_t version = 0;      // of the map
  // Number of the last applied map change, unique in the process across all scenes. Drawing code
  // compares it to detect whether the map changed.
  uint64_t told = 0;
  std::map<KeyFrameId, SceneKeyFrame> keyframes;
  std::map<LandmarkId, SceneLandmark> landmarks;
  std::vector<MapWorld> worlds;  // sorted by map
  std::vector<SceneFrame> path;
  size_t most_frames = 36000;  // of `path`; beyond, older ones are thinned out
  std::vector<SceneEvent> events;
  int frames = 0;                                                // number of frame messages
  uint32_t told_keyframes = 0, told_landmarks = 0, matches = 0;  // of the last frame

  // Of the last frame.
  SceneNow now;
  std::vector<SceneFeature> features;
  std::vector<SceneBox> boxes;
  float detection_age = -1;  // seconds; negative: no result of the detector yet
  int outlines = 0;          // number of outlines of moving parts

  // Map of the last frame with a pose, else of the newest keyframe; invalid: no map.
  MapId ActiveMap() const;
  std::string UnitOf(MapId map) const;  // of the map's lengths: "m" or "map units"
  // T_world_camera of the last frame in the current map, or its predicted pose; nullopt: unknown.
  std::optional<Se3> CameraPose() const;
  Eigen::Vector3d PointOf(const SceneLandmark& landmark) const;  // in the world
  Se3 PoseOf(const SceneFrame& frame) const;  // T_world_camera; requires a valid reference
  // Appends the keyframe's semi-dense points.
  void AddDepth(const SceneKeyFrame& keyframe, Cloud& points_world) const;
};

}  // namespace alidade
