// What is told of a run, how exactly and how often: stream.… after --set.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/stream/settings.h"

namespace alidade {

struct StreamFeedSettings {
  StreamSettings stream;
  int picture_width = 400;    // pixels; the camera's picture is scaled down to it
  int picture_quality = 70;   // of JPEG, 1…100: 11-14 kB at 320 pixels
  double pictures_hz = 10;    // pictures a second, at most: by the recording's clock
  double whole_seconds = 10;  // of a file, between two whole states: what a reader may begin at
  // Of MCAP files: what is told as a whole (path, landmarks, semi-dense points) comes so many
  // seconds apart, each for itself; larger ones less often, so that each takes no more bytes of a
  // second than this. An hour's path is 8 MB.
  double mcap_seconds = 1;
  double mcap_rate = 1e6;
  int waiting = 8;     // frames that wait to be encoded; of more, the newest counts (with a
                       // file: the run waits)
  void Check() const;  // throws Error (usage) naming the field that cannot be

  // As SlamSettings::Set() and All(); names begin with "stream.".
  void Set(const std::string& name, const std::string& value);
  std::vector<std::pair<std::string, std::string>> All() const;
};

}  // namespace alidade
