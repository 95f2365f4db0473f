// The data streamed for one frame, and how to collect it from a Slam.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/system/slam.h"

namespace ALIDADE_API alidade {

// An encoded image; empty: none.
struct StreamPicture {
  int width = 0, height = 0;
  std::string type, bytes;  // "image/jpeg"
};

// Milliseconds per frame, in this order: frame, extract, track, map, loop, semidense, detect,
// dynamics; negative: did not run.
using StreamMilliseconds = std::array<float, 8>;

// A detection in pixels of the camera's image, from edge to edge: the first pixel covers 0 to 1.
struct StreamBox {
  cv::Rect2f box;
  float score = 0;  // 0…1
  std::string label;
};

// One frame after it was processed.
struct StreamFrame {
  int number = 0;   // in the recording
  double time = 0;  // seconds
  TrackResult result;
  FramePose pose;  // from Slam::Trajectory(): the pose relative to a keyframe
  StreamMilliseconds ms{-1, -1, -1, -1, -1, -1, -1, -1};
  std::vector<FeatureUse> features;
  cv::Mat mover_mask;  // CV_8U, 255 at moving parts; empty: none
  std::vector<StreamBox> detections;
  double detection_age = -1;  // seconds since the frame of the detections; negative: no result yet
  StreamPicture picture;
  MapSnapshot map;  // snapshot after the frame
  Camera camera;    // current estimate; width 0: unchanged
};

// Collects the data of the frame `slam` tracked last, without an image. `number` and `time` are
// those of the recording, `result` is what Track() returned. `latest`: Slam::Latest() after the
// previous frame ({} initially); updated.
StreamFrame FrameAsLeft(const Slam& slam, int number, double time, const TrackResult& result,
                        LatestTimes& latest);

}  // namespace alidade
