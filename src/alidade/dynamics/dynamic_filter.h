// Estimates for each keypoint the probability that it belongs to a static part of the scene. Use
// one instance per stream; call Advance, Judge and Remember in this order for each frame.
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
  cv::Mat gray;     // CV_8U, the camera's size
  // Registered to `gray`, CV_16U in camera.depth_factor units or CV_32F in meters; may be empty.
  cv::Mat depth;
  cv::Mat right;  // CV_8U, rectified; may be empty
};

// The world frame a pose refers to. Views from another world cannot be compared.
struct WorldId {
  MapId map;
  uint64_t corrections = 0;  // corrections of the map store: loop closures and merges move worlds
  bool operator==(const WorldId& other) const {
    return map == other.map && corrections == other.corrections;
  }
};

// The predicted pose of the camera.
struct PoseGuess {
  Se3 T_camera_world;
  double nearest = 0.4;  // meters or map units: the smallest depth in the scene
  WorldId world = {};
};

class DynamicFilter {
 public:
  // `class_names`: those of the detector whose results will be passed to Advance(); may be empty.
  DynamicFilter(const Camera& camera, const DynamicsSettings& settings,
                std::span<const std::string> class_names);
  DynamicFilter(const DynamicFilter&) = delete;
  DynamicFilter& operator=(const DynamicFilter&) = delete;

  // Starts a frame before its features are extracted: updates optical flow, depth and the predicted
  // boxes of objects. `arrived`: a new result of the detector, for this frame or an earlier one.
  void Advance(const DynamicInput& input, const std::optional<FrameDetections>& arrived);
  // Mask of the expected moving objects, 255 = moving, one pixel per cell. The extractor avoids
  // these cells.
  cv::Mat ExpectedMovers() const;
  // Sets frame.static_probability. `guess`: the predicted or aligned pose; null when there is none.
  void Judge(Frame& frame, const PoseGuess* guess);
  // Instead of Judge(), where only RivalShare() and MovedShare() are asked for: with depth,
  // surfaces are not compared with earlier views.
  void JudgeTracks(const PoseGuess* guess);
  // Ends the frame. `T_camera_world`: its pose in `world`; null when lost. Tracks are started at
  // its keypoints.
  void Remember(const Frame& frame, const Se3* T_camera_world, const WorldId& world);
  // Before Remember(), for a frame without features of its own: starts tracks at any corners that
  // are not in `left_out` (see FlowTracks), because landmarks are rarely on moving objects.
  void SeedCorners(const cv::Mat& left_out) { tracks_.SeedCorners(left_out, camera_); }

  // Share of the image that agrees on a motion other than that of the pose passed to Judge(), 0…1;
  // see ShareOfRivalMotion().
  double RivalShare() const;
  // Share of moving tracks among those that Judge() classified, 0…1; 0 when fewer than
  // votes.agreement_tracks were classified.
  double MovedShare() const;
  void Forget();  // Clears what was estimated from poses that turned out to be wrong.

  // What this frame shows at the expected position of a landmark. `p`: in the camera's frame.
  Sight Look(const Eigen::Vector3d& p) const;

  // Mask of the moving parts of the image: CV_8U, 255 = moving, the camera's size, raw pixels.
  cv::Mat Mask() const;
  // A copy of the log-odds of being static, CV_32F, one pixel per cell. Mask() is made from it.
  cv::Mat BeliefOfCells() const;
  const std::vector<MovingObject>& objects() const { return objects_.objects(); }

 private:
  void Enter(const WorldId& world);
  struct GeometryBelief {
    std::vector<float> log_odds;  // of being static, per cell
    std::vector<int8_t> votes;    // per track
    // Cells (nonzero) that are certainly static; they are removed only from the rim of a
    // detection's box. May be empty.
    std::vector<uint8_t> proven;
  };
  FrameBelief Unknown() const;
  void Judge(const PoseGuess* guess, bool surfaces);
  GeometryBelief JudgeGeometry(const PoseGuess* guess, bool surfaces);
  GeometryBelief JudgeWithDepth(const PoseGuess& guess, bool surfaces);
  GeometryBelief JudgeWithoutDepth(const PoseGuess* guess);
  // Finds the cells that each object covers: sets judged.object and judged.resting.
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
  std::deque<double> times_;  // times of the last frames, newest first, seconds
  FrameBelief belief_;        // of the current frame; before Judge(): the prediction
  WorldId world_;
};

// DynamicFilter::Mask() from BeliefOfCells(); `size`: the camera's.
cv::Mat MaskOf(const cv::Mat& belief_of_cells, cv::Size size);

}  // namespace alidade
