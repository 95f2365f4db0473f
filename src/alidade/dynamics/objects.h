// Things a detector has found, carried from frame to frame: its answers are late, and some are
// missing.
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "alidade/detect/detector.h"
#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/settings.h"
#include "alidade/dynamics/surface_belief.h"

namespace alidade {

struct MovingObject {
  int id = 0;
  int class_id = -1;
  bool carried = false;                   // moves only when someone moves it
  cv::Rect2f box;                         // in the present frame, raw pixels
  std::deque<cv::Rect2f> past;            // in the frames before, the last one first
  cv::Point2f velocity;                   // of the box, pixels per frame
  double seen = 0;                        // time of the last frame it was detected in, seconds
  float static_log_odds = kObjectStatic;  // rises while what it covers is seen to rest
  std::vector<int> cells;  // what of the picture it covers, sorted; found anew in every frame
};

class ObjectTracks {
 public:
  ObjectTracks(const DynamicsSettings& settings, std::span<const std::string> class_names);

  // Moves every object on to the frame the tracks are in: by the flow of what it covers, else as it
  // moved before. Those not detected for too long, or gone from the picture, are dropped.
  void Advance(std::span<const FlowTrack> tracks, const Cells& cells, double time, cv::Size image);
  // An answer of the detector for the frame `ago` frames before the present one, taken at `seen`
  // (seconds).
  void Update(std::span<const Detection> detections, int ago, double seen,
              std::span<const FlowTrack> tracks);
  // Belief that an object rests, by the tracks on its cells. `votes`: -1, 0, 1 of each track:
  // moved, unknown, stood still.
  void JudgeRest(std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                 const Cells& cells);
  std::vector<MovingObject>& objects() { return objects_; }
  const std::vector<MovingObject>& objects() const { return objects_; }

 private:
  enum class Role : uint8_t { kNone, kMoving, kCarried };
  Role RoleOf(int class_id) const;

  DynamicsSettings settings_;
  std::vector<Role> roles_;  // by class
  std::vector<MovingObject> objects_;
  int next_id_ = 0;
};

// The cells of the picture that an object covers, sorted: of the surface that fills the middle of
// its box all that depth leads to without a step. `depth`: of each cell, metres, 0 = unknown.
// `static_log_odds`: of each cell; what is known well to stand still is something else, such as the
// floor.
std::vector<int> FindForeground(const Cells& cells, std::span<const float> depth,
                                std::span<const float> static_log_odds, const cv::Rect2f& box,
                                const BoxSettings& settings = {});
// All in the box.
std::vector<int> CellsInBox(const Cells& cells, const cv::Rect2f& box);
// Those of an oval in the box: all that can be said without depth.
// `proven`: cells (nonzero) that stand still for certain, left out at the rim; may be empty.
std::vector<int> CellsInOval(const Cells& cells, const cv::Rect2f& box,
                             std::span<const uint8_t> proven = {},
                             const BoxSettings& settings = {});

}  // namespace alidade
