// What a reader of the stream knows: messages put together again. The C++ counterpart of
// web/scene's, for tests and for what draws without a browser.
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
  uint64_t depth_told = 0;  // StreamScene::told when they were; 0: never
};

// Told in a keyframe: p_world = T_world_camera * (scale * p).
struct SceneLandmark {
  KeyFrameId keyframe;
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
};

struct SceneFrame {
  int number = 0;
  int state = 0;  // TrackState
  double time = 0;
  KeyFrameId reference;  // none: no pose
  Se3 T_reference_camera;
};

// A feature of the last frame.
struct SceneFeature {
  double x = 0, y = 0;  // pixels
  int use = 0;          // stream::Use
};

// What a detector found; pixels, from edge to edge.
struct SceneBox {
  float x = 0, y = 0, width = 0, height = 0;
  float score = 0;
  std::string label;
};

struct SceneEvent {
  int kind = 0;  // stream::EventKind
  int number = 0;
  double time = 0;   // seconds
  bool bad = false;  // lost, cut, given up, warned of
  std::string text;
};

// The last frame, as it was when it was done.
struct SceneNow {
  int number = 0;
  int state = 0;    // TrackState
  double time = 0;  // seconds
  std::string reason;
  MapId map;                          // none: no pose
  std::optional<Se3> T_world_camera;  // when tracked
  std::optional<Se3> T_world_guess;   // when lost a moment ago: where the last motion leads
  uint32_t keyframes = 0, landmarks = 0, matches = 0, maps = 0;
  std::vector<float> ms;  // of stream.fbs' stages; below 0: not run
  int picture_width = 0, picture_height = 0;
  std::string picture, picture_type;  // empty: none
};

class StreamScene {
 public:
  // Throws Error (input) saying what is wrong with bytes that are no message of ours, or that tell
  // of what was never told; the scene may then have taken part of the message.
  void Take(std::string_view message);

  int width = 0, height = 0;  // of the camera
  Camera camera;              // size, focal lengths, centre, distortion and baseline
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();  // see SourceInfo
  std::string source, unit;
  uint64_t version = 0;  // of the map
  // Of the last map change taken; no two changes in a process have the same one, whichever scene
  // takes them: who has drawn a scene with this value knows that it has its map.
  uint64_t told = 0;
  std::map<KeyFrameId, SceneKeyFrame> keyframes;
  std::map<LandmarkId, SceneLandmark> landmarks;
  std::vector<SceneFrame> path;
  std::vector<SceneEvent> events;
  int frames = 0;                                                // messages of frames
  uint32_t told_keyframes = 0, told_landmarks = 0, matches = 0;  // counts of the last frame

  // Of the last frame.
  SceneNow now;
  std::vector<SceneFeature> features;
  std::vector<SceneBox> boxes;
  float detection_age = -1;  // seconds; below 0: the detector has not answered
  int outlines = 0;          // of what was left out

  // The map that the last frame with a pose is in, else that of the newest keyframe; none: no map.
  MapId ActiveMap() const;
  // T_world_camera of the last frame, by the map as it is now, or the guess; none: not known.
  std::optional<Se3> CameraPose() const;
  Eigen::Vector3d PointOf(const SceneLandmark& landmark) const;  // in the world
  Se3 PoseOf(const SceneFrame& frame) const;  // T_world_camera; needs a reference
  void AddDepth(const SceneKeyFrame& keyframe, Cloud& points_world) const;  // its semi-dense points
};

}  // namespace alidade
