#include "alidade/stream/settings.h"

#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> StreamSettings::Table() {
  using T = StreamSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::depth_points>("stream.depth_points", FromTo(0, 1000000), "points",
                                      "Most semi-dense points sent of a keyframe."),
      ExpertSetting<&T::edge_shared>(
          "stream.edge_shared", AtLeast(1), "landmarks",
          "Landmarks that two keyframes must share to be drawn with an edge."),
      ExpertSetting<&T::landmark_tolerance>(
          "stream.landmark_tolerance", {.min = 0, .max = 0.1, .open_max = true}, "",
          "A landmark is sent again when it moved by more than this share of its distance."),
      ExpertSetting<&T::outline_tolerance>("stream.outline_tolerance", FromTo(0, 100), "px",
                                           "Accuracy of the outlines of excluded objects."),
      ExpertSetting<&T::path_frames>(
          "stream.path_frames", AtLeast(100), "frames",
          "Frames of the path kept for late viewers; beyond, older ones are thinned out."),
      ExpertSetting<&T::detection_seconds>("stream.detection_seconds", kNotNegative, "s",
                                           "Older answers of the detector are not sent."),
  };
  return kRows;
}

void StreamSettings::Check() const { CheckRanges(*this); }

}  // namespace alidade
