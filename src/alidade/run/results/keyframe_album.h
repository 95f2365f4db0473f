// Small pictures of some keyframes, kept while a run goes on, for its report.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/system/slam.h"

namespace alidade {

class KeyframeAlbum {
 public:
  // A frame that became a keyframe; `index`: its number among those Track() took. What there is no
  // memory for is left out.
  void Add(int index, const SourceFrame& frame, const Slam& slam);

  struct Page {
    int index = 0;
    double time = 0;                   // seconds
    cv::Mat image;                     // grey or blue green red, kWide pixels wide
    cv::Mat depth;                     // the sensor's, as stored, as large; empty: none
    std::vector<FeatureUse> features;  // in pixels of `image`
  };
  const std::vector<Page>& pages() const { return pages_; }

  static constexpr int kWide = 320;  // pixels

 private:
  // When there are this many every second one goes, and from then on every second is not taken: a
  // run of any length is covered evenly, in 5 MB at most.
  static constexpr size_t kMost = 16;
  std::vector<Page> pages_;
  int step_ = 1, met_ = 0;  // one of how many keyframes is taken; how many there were
};

}  // namespace alidade
