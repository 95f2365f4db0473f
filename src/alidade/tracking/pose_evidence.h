// How probable it is that the pose of a frame is right, from what the frame shows of the map.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"
#include "alidade/map/measurement.h"

namespace ALIDADE_API alidade {

struct Setting;

// Shares, rates and probabilities of the world.
struct PoseEvidenceSettings {
  double occluded =
      0.2;  // P(a part of the image, a twelfth, does not show the map at a right pose)
  double look_alike = 0.02;   // P(such a part agrees with the map at a wrong pose)
  double jump_rate = 0.2;     // cuts of the recording and the like per second
  double found_again = 0.05;  // P(right) of a candidate of place recognition before it is compared
  double min_probability = 0.99;  // a frame whose pose is less probably right has none
  double min_keyframe = 0.99;     // and becomes no keyframe, where min_probability is lower

  static std::span<const Setting> Table();
};

// log(p / (1 - p)) and its inverse.
double LogOdds(double probability);
double Probability(double log_odds);

// Log-odds that the camera is where the motion leads, after `seconds` in which the recording may
// have been cut. `before`: of the pose at their beginning.
double AfterSeconds(double before, double seconds, const PoseEvidenceSettings& settings);

// The log-likelihood ratio of a right to a wrong pose, given which of the landmarks expected in the
// image were found near their projections, and how near.
//
// Right: a share p of them is found, with errors that are normal with s times the nominal noise; p
// and s are the same in the whole image and unknown (uniform over kFound; blur and rolling shutter
// make s large). Wrong: a keypoint with a similar descriptor is in the search window by chance.
// With n keypoints of the landmark's levels per σ², of which a share q is similar, one is
// found with 1 - exp(-q n A) in the window's area A. The pose is fitted to such matches, so that
// their errors are not larger than those of a blurred frame. q depends on the texture and is the
// one that explains the frame best. With depth, a chance disparity is drawn from those of the
// frame, one for the surface in a part of the image.
//
// Landmarks within 1/16 of the image's width share their pixels, and count together as one. A part
// of 1/4 by 1/3 of the image may be occluded at a right pose, and show a look-alike at a wrong one,
// which bounds what it can say.
class PoseEvidence {
 public:
  // `window`: largest distance at which a landmark is found, in σ. `disparities`: whether errors of
  // disparity are known.
  PoseEvidence(const Frame& frame, int width, int height, const MeasurementNoise& noise,
               double window, bool disparities, const PoseEvidenceSettings& settings);

  // Of landmarks that are looked for by aligning patches, at which a patch of another place agrees
  // with probability 1 - exp(-q).
  PoseEvidence(int width, int height, double window, const PoseEvidenceSettings& settings);

  // A landmark that was expected at (u, v), undistorted pixels, on `level`, and not found.
  void Missed(double u, double v, int level);
  // Found there with the squared error `chi2` (σ², of the pixel) and `chi2_disparity` (< 0:
  // unknown).
  void Found(double u, double v, int level, double chi2, double chi2_disparity);

  // Natural logarithm; 0 without landmarks.
  double LogLikelihoodRatio() const;

 private:
  static constexpr int kColumns = 16, kRows = 12, kPerPart = 4, kParts = 12;
  static constexpr std::array<double, 5> kSimilar = {0.04, 0.08, 0.16, 0.32, 0.64};    // q
  static constexpr std::array<double, 6> kFound = {0.15, 0.25, 0.4, 0.55, 0.7, 0.85};  // p

  // Sums over landmarks of a cell, then of means over cells of a part.
  struct Sums {
    double landmarks = 0, found = 0, chi2 = 0, disparities = 0, chi2_disparity = 0;
    std::array<double, kSimilar.size()> chance{};  // log P(found or missed | wrong), by q
  };
  // `in_window`: n A.
  void SetChance(int level, double in_window);
  size_t CellAt(double u, double v) const;
  static size_t PartOf(size_t cell);

  PoseEvidenceSettings settings_;
  int width_, height_;
  double window2_;                // σ²
  double disparity_spread2_ = 0;  // of the frame's disparities and of one error, σ²; 0: not used
  // log P(found) and log P(missed) of a wrong pose, by level and q.
  std::array<std::array<double, kSimilar.size()>, kPyramidLevels> log_found_, log_missed_;
  std::array<Sums, kColumns * kRows> cells_;
};

}  // namespace alidade
