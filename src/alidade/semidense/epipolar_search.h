// Inverse depth of a keyframe's edge pixels from one other keyframe: best match along each epipolar
// line (Mur-Artal & Tardós, RSS 2015, §III-A).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "alidade/geometry/camera.h"
#include "alidade/semidense/epipolar_lines.h"
#include "alidade/semidense/gradient_image.h"
#include "alidade/semidense/hypothesis.h"
#include "alidade/semidense/report.h"
#include "alidade/semidense/settings.h"

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
  std::span<const DepthInterval> intervals;  // at least one
};

// Searches the epipolar lines of one pair. Not thread-safe.
class EpipolarSearch {
 public:
  EpipolarSearch(const EpipolarPair& pair, const Camera& camera, const SemiDenseSettings& settings);

  // Best match of each pixel within any of its intervals, for up to kLanes pixels. Unknown if depth
  // is not observable along the line or no match is good enough.
  Lanes<Hypothesis> Search(std::span<const EpipolarQuery> queries, SearchCount& count);

 private:
  static constexpr int kPattern = 2 * kHalf + 1;
  // Samples around a match: the pattern's and one on both sides; with padding for vector loads.
  static constexpr int kAround = 12;

  // Best positions so far.
  struct Matches {
    Lanes<int32_t> cost{-1, -1, -1, -1};  // -1: none yet
    Lanes<int32_t> place{};               // whole pixel along the axis
    Lanes<float> across{}, slope{};       // the line at that position
    std::array<std::array<uint32_t, kAround>, kLanes> samples{};
  };

  void TakePattern(const EdgePixel& pixel, const EpipolarLines& lines, int lane);
  void WalkLine(const LineParts& parts, bool rows, int lane);
  int LeastCost(int lane, int places);
  void SearchPart(const LineParts& parts, bool rows, int lane, Matches& matches);
  bool SumsOf(const Matches& matches, int lane, int32_t& gradient2, int32_t& product) const;
  Lanes<Hypothesis> Refine(const EpipolarLines& lines, const Matches& matches,
                           const Lanes<int>& gradient_step) const;
  bool Turned(const cv::Mat& direction, int x, int y, int gradient_step) const;

  const EpipolarPair& pair_;
  const SemiDenseSettings& settings_;
  EpipolarGeometry geometry_;
  // Rotation of the image about the optical axis, and tolerance of gradient directions; in
  // direction steps.
  int turn_, max_turn_;
  // Samples: intensity in the low half, gradient in the high half.
  std::array<std::array<uint32_t, 2 * kLanes>, kLanes> patterns_{};  // unused ones are 0
  std::array<uint32_t, kMaxPlaces + 2 * kLineMargin + kAround> line_{};
  int32_t least_cost_ = 0;
};

}  // namespace alidade
