// Detected objects, tracked from frame to frame, because detector results are late and sometimes
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
  bool carried = false;                   // moves only when a person moves it
  cv::Rect2f box;                         // in the current frame, raw pixels
  std::deque<cv::Rect2f> past;            // in the previous frames, newest first
  cv::Point2f velocity;                   // of the box, pixels per frame
  double seen = 0;                        // time of the last frame with a detection, seconds
  float static_log_odds = kObjectStatic;  // log-odds of being static; rises while the object rests
  std::vector<int> cells;                 // the cells it covers, sorted; recomputed for every frame
};

class ObjectTracks {
 public:
  ObjectTracks(const DynamicsSettings& settings, std::span<const std::string> class_names);

  // Moves every object to the current frame by the median flow of the cells it covers, or by its
  // previous velocity. Drops objects without a detection for bridge_seconds and those outside the
  // image.
  void Advance(std::span<const FlowTrack> tracks, const Cells& cells, double time, cv::Size image);
  // Adds a detector result for the frame `ago` frames before the current one, whose time is `seen`
  // (seconds).
  void Update(std::span<const Detection> detections, int ago, double seen,
              std::span<const FlowTrack> tracks);
  // Updates the belief that objects rest, from the tracks on their cells. `votes`: of each track,
  // -1 moving, 0 unknown, 1 static.
  void JudgeRest(std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                 const Cells& cells);
  std::vector<MovingObject>& objects() { return objects_; }
  const std::vector<MovingObject>& objects() const { return objects_; }

 private:
  enum class Role : uint8_t { kNone, kMoving, kCarried };
  Role RoleOf(int class_id) const;

  DynamicsSettings settings_;
  std::vector<Role> roles_;  // per class
  std::vector<MovingObject> objects_;
  int next_id_ = 0;
};

// The cells that an object covers, sorted: the surface in the middle of its box, grown over cells
// without a depth discontinuity. `depth`: of each cell, meters, 0 = unknown. `static_log_odds`: of
// each cell; cells well known to be static, such as the floor, are excluded.
std::vector<int> FindForeground(const Cells& cells, std::span<const float> depth,
                                std::span<const float> static_log_odds, const cv::Rect2f& box,
                                const BoxSettings& settings = {});
// All cells of the box.
std::vector<int> CellsInBox(const Cells& cells, const cv::Rect2f& box);
// The cells of an oval in the box; used without depth. `proven`: cells (nonzero) that are certainly
// static, which are excluded near the rim; may be empty.
std::vector<int> CellsInOval(const Cells& cells, const cv::Rect2f& box,
                             std::span<const uint8_t> proven = {},
                             const BoxSettings& settings = {});

}  // namespace alidade
