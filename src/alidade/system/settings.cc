#include "alidade/system/settings.h"

#include "alidade/base/error.h"
#include "alidade/system/setting_names.h"

namespace alidade {

std::vector<SettingsPart> SlamSettings::Parts() {
  return {PartOf(*this),
          PartOf(tracker),
          PartOf(tracker.extractor),
          PartOf(tracker.motion),
          PartOf(tracker.evidence),
          PartOf(mapper),
          PartOf(loop),
          PartOf(loop.reach),
          PartOf(places),
          PartOf(start),
          PartOf(start.two_view),
          PartOf(early),
          PartOf(trajectory),
          PartOf(time),
          PartOf(semidense),
          PartOf(dynamics),
          PartOf(dynamics.detector),
          PartOf(refine),
          PartOf(readout)};
}

void SlamSettings::Set(const std::string& name, const std::string& value) {
  SetByName(Parts(), name, value);
}

std::vector<std::pair<std::string, std::string>> SlamSettings::All() const {
  SlamSettings copy = *this;
  return AllByName(copy.Parts());
}

void SlamSettings::ApplyProfile(const std::string& profile) {
  if (profile == "desktop") return;
  if (profile != "phone") ThrowUsage("unknown profile '" + profile + "'; known: desktop, phone");
  image_width = 400;
  tracker.extractor.features = 500;
  semidense.keyframes = 5;
  // In a smaller picture edges are steeper: 12 would take the same ones. 16 takes two thirds of
  // them at the same error (kitchen: median 1.9 %), so that a keyframe costs 15 ms (U = 3.6 ms),
  // not 22.
  semidense.min_gradient = 16;
  // A phone's own lens is within 10 % of what is assumed; what was put into the picture stays
  // there.
  refine.begin_anew = 0.1;
  tracker.match_scale = mapper.match_scale = start.match_scale = loop.match_scale = 0.8;
}

void SlamSettings::WaryOfTurns() {
  // Relative uncertainty of an assumed focal length: phones and webcams have 50 to 90 degrees.
  constexpr double kAssumedLens = 0.6;
  double& wary = start.two_view.lens_uncertainty;
  if (wary == 0) wary = kAssumedLens;
  // A wrong focal length makes all rotations wrong by the same share.
  loop.turn_drift = std::max(loop.turn_drift, kAssumedLens);
}

void SlamSettings::EnableSelfCalibration() {
  WaryOfTurns();
  readout.enabled = false;
  refine.enabled = true;
}

std::span<const Setting> TrajectorySettings::Table() {
  static constexpr Setting kRows[] = {
      PublicSetting<&TrajectorySettings::keep_seconds>(
          "trajectory.keep_seconds", kNotNegative, "s",
          "Poses of older frames are discarded; 0: all are kept."),
  };
  return kRows;
}

void TrajectorySettings::Check() const { CheckRanges(*this); }

std::span<const Setting> EarlyFrameSettings::Table() {
  using T = EarlyFrameSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::max_frames>(
          "early.max_frames", kNotNegative, "frames",
          "One camera: frames before the start of a map that are kept to be localized later; 0: "
          "none."),
      ExpertSetting<&T::settle_frames>("early.settle_frames", kNotNegative, "frames",
                                       "They are localized this many frames after the start."),
      ExpertSetting<&T::max_missed_frames>("early.max_missed_frames", kPositive, "frames",
                                           "After as many consecutive failures the earlier frames "
                                           "are given up."),
      ExpertSetting<&T::max_leap>("early.max_leap", kPositive, "",
                                  "A frame farther from the extrapolated path than this times the "
                                  "expected motion is dropped, "
                                  "with those before it."),
      ExpertSetting<&T::min_leap>("early.min_leap", kNotNegative, "",
                                  "A distance below this share of the median depth is no jump."),
  };
  return kRows;
}

void EarlyFrameSettings::Check() const {
  CheckRanges(*this);
  if (!(leap_seconds > 0)) ThrowUsage("EarlyFrameSettings::leap_seconds must be positive");
}

std::span<const Setting> SlamSettings::Table() {
  using T = SlamSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::image_width>("image_width", ZeroOr(AtLeast(100)), "px",
                                     "Images are scaled to this width; 0: by max_image_side only."),
      PublicSetting<&T::max_image_side>("max_image_side", ZeroOr(AtLeast(100)), "px",
                                        "Larger images are downscaled to this side; 0: never."),
      PublicSetting<&T::seed>("seed", kNotNegative, "", "Seed of every random choice."),
      PublicSetting<&T::new_map_seconds>("new_map_seconds", kNotNegative, "s",
                                         "A lost camera starts a new map only after this time."),
      ExpertSetting<&T::fixed_parts>("fixed_parts", kOnOff, "",
                                     "Look for parts of the image that move with the camera (a "
                                     "hood, a hand), and leave them out."),
      PublicSetting<&T::new_map_frames>(
          "new_map_frames", kPositive, "frames",
          "A lost camera starts a new map only after as many frames with enough keypoints."),
      PublicSetting<&T::min_map_keyframes>("min_map_keyframes", kNotNegative, "keyframes",
                                           "A map left with fewer is dropped."),
  };
  return kRows;
}

void SlamSettings::Check() const {
  CheckRanges(*this);
  tracker.Check();
  mapper.Check();
  loop.Check();
  places.Check();
  semidense.Check();
  dynamics.Check();
  trajectory.Check();
  time.Check();
  start.Check();
  early.Check();
  readout.Check();
  refine.Check();
  if (refine.enabled && sensor != Sensor::kMono)
    ThrowUsage("setting refine.enabled is for one camera (mono)");
}

}  // namespace alidade
