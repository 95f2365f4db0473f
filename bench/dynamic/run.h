// One run over a recording with people in it, and how good it was.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "alidade/evaluation/rpe.h"
#include "alidade/slam.h"
#include "bench/dynamic/mask_scores.h"
#include "bench/dynamic/scene.h"

namespace alidade::bench {

// Of the map with the most frames. All zero (n = 0) where nothing could be matched.
struct DynamicErrors {
  ErrorStatistics ate;                       // metres
  ErrorStatistics every_trans, every_rot;    // RPE of every two poses: metres, degrees
  ErrorStatistics second_trans, second_rot;  // over 1 s
};

// Aligned by Sim(3) with one camera, by SE(3) else.
DynamicErrors EvaluateErrors(const DynamicScene& scene, Sensor sensor, const Trajectory& estimate);

struct DynamicRun {
  DynamicErrors errors;
  Trajectory trajectory;  // of the map with the most frames
  int frames = 0;
  int tracked = 0;  // in all maps
  int start = -1;   // number of the first tracked frame; -1: none
  int lost = 0;     // spans without a pose after the start
  int maps = 0;
  MaskScores masks;
  StageTimes times;
};

// Called after each frame with its index.
using FrameVisitor = std::function<void(size_t index, const Slam& slam)>;

// Inline, with these settings. `detected`: boxes in each frame for MaskScores, may be empty.
DynamicRun RunDynamic(const DynamicScene& scene, const SlamSettings& settings,
                      const std::shared_ptr<Detector>& detector,
                      const std::vector<std::vector<cv::Rect>>& detected = {},
                      const FrameVisitor& visit = nullptr);

}  // namespace alidade::bench
