#include "alidade/run/setup/stream_settings.h"

#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> StreamFeedSettings::Table() {
  using T = StreamFeedSettings;
  static constexpr Setting kRows[] = {
      PublicSetting<&T::picture_width>("stream.picture_width", FromTo(16, 8192), "px",
                                       "Camera images are sent at this width."),
      PublicSetting<&T::picture_quality>("stream.picture_quality", FromTo(1, 100), "",
                                         "JPEG quality of these images."),
      PublicSetting<&T::pictures_hz>("stream.pictures_hz", kNotNegative, "1/s",
                                     "Most images sent per second of the recording."),
      PublicSetting<&T::mcap_seconds>(
          "stream.mcap_seconds", kNotNegative, "s",
          "MCAP files: shortest time between two copies of the path, landmarks or points."),
      PublicSetting<&T::mcap_rate>("stream.mcap_rate", kPositive, "bytes/s",
                                   "MCAP files: larger copies are written less often, so that each "
                                   "takes at most this rate."),
      ExpertSetting<&T::whole_seconds>(
          "stream.whole_seconds", kPositive, "s",
          "Recorded streams: time between two complete states, where a reader can begin."),
      ExpertSetting<&T::max_waiting>("stream.max_waiting", AtLeast(1), "frames",
                                     "Most frames waiting to be encoded; beyond, the newest "
                                     "counts, or a recording run waits."),
  };
  return kRows;
}

void StreamFeedSettings::Check() const {
  stream.Check();
  CheckRanges(*this);
}

}  // namespace alidade
