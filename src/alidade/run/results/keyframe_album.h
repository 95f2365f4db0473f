// Keeps small images of some keyframes during a run, for its report.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/system/slam.h"

namespace alidade {

class KeyframeAlbum {
 public:
  // A frame that became a keyframe; `index`: its number among those that Track() processed. Skipped
  // if memory is exhausted.
  void Add(int index, const SourceFrame& frame, const Slam& slam);

  struct Page {
    int index = 0;
    double time = 0;                   // seconds
    cv::Mat image;                     // gray or BGR, kWide pixels wide
    cv::Mat depth;                     // depth of the sensor as stored, same size; empty: none
    std::vector<FeatureUse> features;  // in pixels of `image`
  };
  const std::vector<Page>& pages() const { return pages_; }

  static constexpr int kWide = 320;  // pixels

 private:
  // At this number, every second image is removed and from then on every second keyframe is
  // skipped: runs of any length are covered evenly, with at most 5 MB.
  static constexpr size_t kMost = 16;
  std::vector<Page> pages_;
  int step_ = 1, met_ = 0;  // every step_-th keyframe is kept; met_: number of keyframes so far
};

}  // namespace alidade
