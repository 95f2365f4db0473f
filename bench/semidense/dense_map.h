// A finished map with the pictures of its keyframes and their true depth: semi-dense mapping can be
// tried on it again and again, always from the same poses.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/evaluation/depth_error.h"
#include "alidade/features/picture.h"
#include "alidade/io/frame_source.h"
#include "alidade/map/map_store.h"
#include "alidade/system/settings.h"

namespace alidade::bench {

struct DenseKeyFrame {
  KeyFrameId id;
  std::shared_ptr<const Picture> picture;  // as Slam has it: of the size in use
  cv::Mat image;                           // CV_8U, as recorded
  cv::Mat truth;                           // CV_32F, metres
};

struct DenseMap {
  Camera camera;                  // as used: scaled by the profile
  Sensor sensor = Sensor::kMono;  // that the map was made with
  Sensor source = Sensor::kMono;  // of the recording: what it could have been made with
  bool rendered = false;          // the truth is exact, not a sensor's
  int frames = 0;                 // of the recording, that were given
  int tracked = 0;
  MapSnapshot map;
  std::vector<DenseKeyFrame> keyframes;  // those with truth
};

// Runs Slam, inline and without semi-dense mapping, over the first `count` frames.
DenseMap MakeDenseMap(const std::string& source, int count, const SlamSettings& settings);

// The depth `map` holds against the truth. `map`: that of `dense`, with depth. Maps of one camera
// are scaled.
DepthScores ScoreDense(const DenseMap& dense, const MapSnapshot& map);

}  // namespace alidade::bench
