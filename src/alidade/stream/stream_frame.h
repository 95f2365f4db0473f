// One frame as it is streamed, and how it comes from a system.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/system/slam.h"

namespace ALIDADE_API alidade {

// A picture as its carrier coded it; empty: none.
struct StreamPicture {
  int width = 0, height = 0;
  std::string type, bytes;  // "image/jpeg"
};

// Milliseconds of a frame, in this order: frame, extract, track, map, loop, semidense, detect,
// dynamics; below 0: not run.
using StreamMilliseconds = std::array<float, 8>;

// What a detector found, in pixels of the camera's picture, from edge to edge: the first one covers
// 0 to 1.
struct StreamBox {
  cv::Rect2f box;
  float score = 0;  // 0…1
  std::string label;
};

// One frame as the system left it.
struct StreamFrame {
  int number = 0;   // of the recording
  double time = 0;  // seconds
  TrackResult result;
  FramePose pose;  // of Slam::Trajectory(): what the frame hangs on
  StreamMilliseconds ms{-1, -1, -1, -1, -1, -1, -1, -1};
  std::vector<FeatureUse> features;
  cv::Mat mover_mask;  // CV_8U, 255 where left out; empty: nothing
  std::vector<StreamBox> detections;
  double detection_age = -1;  // seconds since the frame they are of; below 0: no answer so far
  StreamPicture picture;
  MapSnapshot map;  // taken after it
  Camera camera;    // as it is known by then; of no size: as before
};

// The frame `slam` tracked last, without a picture: `number` and `time` are the recording's,
// `result` what Track() returned. `latest`: what Slam::Latest() said after the frame before ({} at
// first); takes what it says now.
StreamFrame FrameAsLeft(const Slam& slam, int number, double time, const TrackResult& result,
                        LatestTimes& latest);

}  // namespace alidade
