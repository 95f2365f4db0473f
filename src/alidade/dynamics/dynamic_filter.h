// Tells for every keypoint how likely it is part of what stands still. One instance per stream; in
// the order Advance, Judge, Remember for each frame.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/frame_belief.h"
#include "alidade/dynamics/history.h"
#include "alidade/dynamics/landmark_belief.h"
#include "alidade/dynamics/objects.h"
#include "alidade/dynamics/settings.h"
#include "alidade/dynamics/surface_belief.h"
#include "alidade/dynamics/track_belief.h"
#include "alidade/features/frame.h"

namespace alidade {

struct DynamicInput {
  int number = 0;   // Frame::number
  double time = 0;  // seconds
  cv::Mat gray;     // CV_8U, of the camera's size
  cv::Mat depth;  // registered, CV_16U in camera.depth_factor units or CV_32F metres; may be empty
  cv::Mat right;  // CV_8U, rectified; may be empty
};

// Whose world a pose is in: views of another cannot be held against it.
struct WorldId {
  MapId map;
  uint64_t corrections = 0;  // of the map store: loops and merges move worlds
  bool operator==(const WorldId& other) const {
    return map == other.map && corrections == other.corrections;
  }
};

// What is known of the camera before the pose is.
struct PoseGuess {
  Se3 T_camera_world;
  double nearest = 0.4;  // metres or map units: nothing is nearer
  WorldId world = {};
};

class DynamicFilter {
 public:
  // `class_names`: of the detector whose answers will come; may be empty.
  DynamicFilter(const Camera& camera, const DynamicsSettings& settings,
                std::span<const std::string> class_names);
  DynamicFilter(const DynamicFilter&) = delete;
  DynamicFilter& operator=(const DynamicFilter&) = delete;

  // A new frame, before its features: flow, depth, and where the known objects are by now.
  // `arrived`: an answer of the detector, for this frame or one before it.
  void Advance(const DynamicInput& input, const std::optional<FrameDetections>& arrived);
  // 255 where movers are expected, one pixel for each cell: features there are of little use.
  cv::Mat ExpectedMovers() const;
  // Fills frame.static_probability. `guess`: null when there is none.
  void Judge(Frame& frame, const PoseGuess* guess);
  // Ends the frame. `T_camera_world`: its pose, in that world; null when lost.
  void Remember(const Frame& frame, const Se3* T_camera_world, const WorldId& world);

  // Share of the picture that agrees on another motion than that of the pose just judged by: see
  // ShareOfRivalMotion().
  double RivalShare() const;
  // Of the tracks just judged of which flow tells whether they move, those that do; 0 when there
  // are fewer than votes.agreement_tracks.
  double MovedShare() const;
  void Forget();  // what was believed by poses that were wrong

  // What there is where a point of the camera's frame should be seen.
  Sight Look(const Eigen::Vector3d& p) const;

  // What is left out as moving, of the camera's size: CV_8U, 255 = moves. Raw pixels.
  cv::Mat Mask() const;
  // What the mask is made of, a copy: log-odds of standing still, CV_32F, one pixel for each cell.
  cv::Mat BeliefOfCells() const;
  const std::vector<MovingObject>& objects() const { return objects_.objects(); }

 private:
  void Enter(const WorldId& world);
  struct GeometryBelief {
    std::vector<float> log_odds;  // of standing still, of each cell
    std::vector<int8_t> votes;    // of each track
    // Of each cell, nonzero: it stands still for certain, which only the rim of a detection's box
    // can hold; may be empty.
    std::vector<uint8_t> proven;
  };
  FrameBelief Unknown() const;
  GeometryBelief JudgeGeometry(const PoseGuess* guess);
  GeometryBelief JudgeWithDepth(const PoseGuess& guess);
  GeometryBelief JudgeWithoutDepth(const PoseGuess* guess);
  // What each object covers of the picture: fills judged.object and judged.resting.
  void FindObjects(std::span<const uint8_t> proven, FrameBelief& judged);
  bool IsCarried(const MovingObject& object, std::span<const float> geometry) const;

  Camera camera_;
  DynamicsSettings settings_;
  Cells cells_;
  FlowTracks tracks_;
  ObjectTracks objects_;
  SurfaceBelief surfaces_;
  TrackBelief track_belief_;
  History history_;

  DynamicInput now_;
  std::deque<double> times_;  // of the last frames, newest first, seconds
  FrameBelief belief_;        // of the present frame; before it is judged, what is expected of it
  WorldId world_;
};

// DynamicFilter::Mask() of BeliefOfCells(); `size`: the camera's.
cv::Mat MaskOf(const cv::Mat& belief_of_cells, cv::Size size);

}  // namespace alidade
