// Tells for every keypoint how likely it is part of what stands still. One instance per stream; in
// the order Advance, Judge, Remember for each frame.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/evidence.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/objects.h"
#include "alidade/dynamics/settings.h"
#include "alidade/features/frame.h"

namespace alidade {

struct DynamicInput {
  int number = 0;   // Frame::number
  double time = 0;  // seconds
  cv::Mat gray;     // CV_8U, of the camera's size
  cv::Mat depth;  // registered, CV_16U in camera.depth_factor units or CV_32F metres; may be empty
  cv::Mat right;  // CV_8U, rectified; may be empty
};

class DynamicFilter {
 public:
  // `class_names`: of the detector whose answers will come; may be empty.
  DynamicFilter(const Camera& camera, const DynamicsSettings& settings,
                std::span<const std::string> class_names);

  // A new frame, before its features: flow, depth, and where the known objects are by now.
  // `arrived`: an answer of the detector, for this frame or one before it.
  void Advance(const DynamicInput& input, const std::optional<FrameDetections>& arrived);
  // 255 where movers are expected, one pixel for each cell: features there are of little use.
  cv::Mat ExpectedMovers() const;
  // Fills frame.static_probability. `T_camera_world`: first guess of the pose; null when there is
  // none.
  void Judge(Frame& frame, const Se3* T_camera_world);
  // Ends the frame. `T_camera_world`: its pose; null when lost. `corrections`: of the map it is in.
  void Remember(const Frame& frame, const Se3* T_camera_world, uint64_t corrections);

  // What is left out as moving, of the camera's size: CV_8U, 255 = moves. Raw pixels.
  cv::Mat Mask() const;
  const std::vector<MovingObject>& objects() const { return objects_.objects(); }

 private:
  void CarryBelief(const Se3* T_camera_world);
  void AddDepthEvidence(const Se3& T_camera_world, std::vector<float>& evidence,
                        std::vector<float>& weights) const;
  void AddFlowEvidence(const Se3& T_camera_world, std::vector<float>& evidence,
                       std::vector<float>& weights);
  void SpreadBelief();
  void FindObjects();
  float Belief(int cell) const;  // log-odds of standing still, objects included
  float BeliefAt(const Keypoint& keypoint) const;

  Camera camera_;
  DynamicsSettings settings_;
  Cells cells_;
  FlowTracks tracks_;
  ObjectTracks objects_;

  DynamicInput now_;
  std::vector<float> depth_;      // of each cell; empty: none is measured
  std::vector<float> belief_;     // log-odds of standing still, of each cell, by geometry
  std::vector<float> certainty_;  // of each cell, 0…1: how much it was itself held against others
  std::vector<uint8_t> object_;   // of each cell: 1 = an object's that moves by itself
  std::deque<std::shared_ptr<const PastView>>
      recent_;  // the last frames, newest first; null where lost
  std::deque<std::shared_ptr<const PastView>> older_;  // some of those before, newest first
  uint64_t corrections_ = 0;
};

}  // namespace alidade
