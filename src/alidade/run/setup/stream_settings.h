// Contents, precision and rate of the stream of a run.
#pragma once

#include <span>

#include "alidade/stream/settings.h"

namespace alidade {

// Range, unit and meaning of the fields: Table() in stream_settings.cc.
struct StreamFeedSettings {
  StreamSettings stream;
  int picture_width = 400;
  // 11 to 14 kB per image at 320 pixels.
  int picture_quality = 70;
  double pictures_hz = 10;
  double whole_seconds = 10;
  // For MCAP files. The path of an hour has 8 MB.
  double mcap_seconds = 1;
  double mcap_rate = 1e6;
  int max_waiting = 8;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
