// Inverse depth of a keyframe's edge pixels from one other keyframe: best match along each epipolar
// line (Mur-Artal & Tardós, RSS 2015, §III-A).
#pragma once

#include <span>

#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"
#include "alidade/semidense/report.h"
#include "alidade/semidense/settings.h"
#include "alidade/semidense/simd/line_search.h"

namespace alidade {

// A reference keyframe and the keyframe that is searched.
struct EpipolarPair {
  const GradientImage* reference = nullptr;
  const GradientImage* other = nullptr;
  cv::Mat values;  // of the reference, adapted to the exposure of `other`
  // Of `other`, rows and columns exchanged: two pixels one above the other are neighbours in memory
  // here, those beside each other in `other->values`.
  cv::Mat other_turned;
  Se3 T_other_reference;

  EpipolarPair(const GradientImage& reference_image, const GradientImage& other_image,
               cv::Mat reference_values, const Se3& T);
};

struct EpipolarQuery {
  EdgePixel pixel;                           // of the reference
  std::span<const DepthInterval> intervals;  // one to kMostIntervals
};

// Searches the epipolar lines of one pair, which it keeps a reference to. Not thread-safe.
class EpipolarSearch {
 public:
  // `search`: the fastest one that this processor admits.
  EpipolarSearch(const EpipolarPair& pair, const Camera& camera, const SemiDenseSettings& settings);
  EpipolarSearch(const EpipolarPair& pair, const Camera& camera, const SemiDenseSettings& settings,
                 LineSearch search);

  // Best match of each pixel within any of its intervals, for up to lanes() pixels. Unknown if
  // depth is not observable along the line or no match is good enough. `found`: one per query.
  void Search(std::span<const EpipolarQuery> queries, std::span<Hypothesis> found,
              SearchCount& count);
  int lanes() const { return lanes_; }  // pixels searched at once

 private:
  const EpipolarPair* pair_;
  LinePair lines_;
  LineSearch search_;
  int lanes_;
  LineQueries queries_{};
};

}  // namespace alidade
