#include "alidade/dynamics/settings.h"

#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/base/settings_table.h"

namespace alidade {

bool LeavesOutFromStart(DynamicsMode mode) {
  return mode == DynamicsMode::kGeometry || mode == DynamicsMode::kFull;
}

const char* NameOf(DynamicsMode mode) {
  switch (mode) {
    case DynamicsMode::kOff:
      return "off";
    case DynamicsMode::kAuto:
      return "auto";
    case DynamicsMode::kGeometry:
      return "geometry";
    case DynamicsMode::kFull:
      break;
  }
  return "full";
}

DynamicsMode DynamicsModeNamed(const std::string& what, const std::string& word) {
  std::vector<std::string> names;
  for (DynamicsMode mode :
       {DynamicsMode::kOff, DynamicsMode::kAuto, DynamicsMode::kGeometry, DynamicsMode::kFull}) {
    if (word == NameOf(mode)) return mode;
    names.push_back(NameOf(mode));
  }
  ThrowUsage(what + " cannot be '" + word + "' (it is one of off, auto, geometry, full)" +
             DidYouMean(word, names));
}

std::span<const Setting> DynamicsSettings::Table() {
  using T = DynamicsSettings;
  using D = CellDepthSettings;
  using V = FlowVoteSettings;
  using F = FeatureBeliefSettings;
  static constexpr const char* kModes[] = {"off", "auto", "geometry", "full", nullptr};
  static constexpr Setting kRows[] = {
      PublicChoice<&T::mode>("dynamics.mode", kModes,
                             "Moving objects: keep, exclude once they disturb, exclude by "
                             "geometry, and by a detector."),
      PublicSetting<&T::moving_classes>("dynamics.moving_classes", kAnyText, "",
                                        "Classes of a detector that move by themselves."),
      PublicSetting<&T::carried_classes>("dynamics.carried_classes", kAnyText, "",
                                         "Classes that move when someone moves them."),
      PublicSetting<&T::detector_every_frames>(
          "dynamics.detector_every_frames", kPositive, "frames",
          "Inline schedule: one frame of this many goes to the detector."),
      PublicSetting<&T::detector_latency_frames>(
          "dynamics.detector_latency_frames", FromTo(0, 30), "frames",
          "Inline schedule: frames until its answer arrives."),
      PublicSetting<&T::detector_rest>(
          "dynamics.detector_rest", FromTo(0, 100), "",
          "Threaded schedule: the detector pauses for this times its last running time."),
      PublicSetting<&T::bridge_seconds>("dynamics.bridge_seconds", kNotNegative, "s",
                                        "How long an object is kept that is no longer detected."),
      ExpertSetting<&T::drop_detections>("dynamics.drop_detections", kZeroToOne, "",
                                         "Share of the detector's answers that are discarded."),
      ExpertSetting<&T::foreground>(
          "dynamics.foreground", kOnOff, "",
          "Exclude only the object's pixels of a detected box; 0: the whole box."),
      ExpertSetting<&T::geometry>(
          "dynamics.geometry", kOnOff, "",
          "Compare flow, epipolar lines and depth with the predicted pose."),
      ExpertSetting<&T::propagate>("dynamics.propagate", kOnOff, "",
                                   "Propagate detections to the current frame."),
      ExpertSetting<&T::weigh>(
          "dynamics.weigh", kOnOff, "",
          "Weight residuals by the probability of being static; 0: all or nothing."),
      ExpertSetting<&T::watch_frames>("dynamics.watch_frames", kPositive, "frames",
                                      "Mode auto: consecutive frames that are checked for motion."),
      ExpertSetting<&T::watch_every>("dynamics.watch_every", kPositive, "frames",
                                     "Mode auto: frames from one such check to the next."),
      ExpertSetting<&T::watch_mean>("dynamics.watch_mean", kPositive, "frames",
                                    "Mode auto: frames over which the share of moving tracks is "
                                    "averaged."),
      ExpertSetting<&T::watch_moved>(
          "dynamics.watch_moved", kPositive, "",
          "Mode auto: share of moving tracks that excludes them, one camera and stereo."),
      ExpertSetting<&T::watch_moved_depth>("dynamics.watch_moved_depth", kPositive, "",
                                           "The same for RGB-D."),
      ExpertSetting<&T::watch_rival_frames>(
          "dynamics.watch_rival_frames", kPositive, "frames",
          "Mode auto: frames with a competing motion that exclude it."),
      ExpertSetting<&T::watch_lens>(
          "dynamics.watch_lens", kNotNegative, "",
          "Mode auto: no check while the focal length is less certain than this."),
      ExpertSetting<&T::depth, &D::surface_step>(
          "dynamics.depth.surface_step", kZeroToOne, "",
          "Relative depth step between two neighboring cells that separates surfaces."),
      ExpertSetting<&T::depth, &D::tolerance>(
          "dynamics.depth.tolerance", FromTo(0, 10), "m",
          "Constant part of the depth difference within one surface."),
      ExpertSetting<&T::votes, &V::moved_px>(
          "dynamics.votes.moved_px", FromTo(0, 100), "px",
          "A track moves when it is farther than this from its epipolar line."),
      ExpertSetting<&T::votes, &V::moved_share>("dynamics.votes.moved_share", FromTo(0, 10), "",
                                                "Plus this share of the track's length."),
      ExpertSetting<&T::votes, &V::consensus>(
          "dynamics.votes.consensus", kZeroToOne, "",
          "Mean vote of the neighboring tracks that decides for a track."),
      ExpertSetting<&T::votes, &V::agreement_sigma>(
          "dynamics.votes.agreement_sigma", FromTo(0.01, 100), "px",
          "Standard deviation of a track from the epipolar geometry that most tracks agree on."),
      ExpertSetting<&T::votes, &V::rival_share>(
          "dynamics.votes.rival_share", kZeroToOne, "",
          "Share of the image that follows a competing motion."),
      ExpertSetting<&T::votes, &V::rival_frames>(
          "dynamics.votes.rival_frames", FromTo(1, 1000), "frames",
          "Frames with a competing motion after which an unconfirmed map starts again."),
      ExpertSetting<&T::surfaces, &SurfaceBeliefSettings::forget>(
          "dynamics.surfaces.forget", kZeroToOne, "1/frame",
          "Share of the way back to unknown that the belief of a cell goes."),
      ExpertSetting<&T::features, &F::enough_share>(
          "dynamics.features.enough_share", kZeroToOne, "",
          "With fewer certainly static features, uncertain ones are used as well."),
      ExpertSetting<&T::features, &F::uncertain_weight>("dynamics.features.uncertain_weight",
                                                        kZeroToOne, "", "Their smallest weight."),
  };
  return kRows;
}

void DynamicsSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("setting expert.dynamics.") + what);
  };
  CheckRanges(*this);
  detector.Check();
  depth.Check();
  history.Check();
  votes.Check();
  surfaces.Check();
  tracks.Check();
  objects.Check();
  box.Check();
  features.Check();
  landmarks.Check();
  require(watch_frames > votes.agreement_ago,
          "watch_frames must exceed FlowVoteSettings::agreement_ago");
  require(watch_mean <= watch_frames, "watch_mean must be at most expert.dynamics.watch_frames");
  require(watch_every >= watch_frames, "watch_every must be at least expert.dynamics.watch_frames");
}

}  // namespace alidade
