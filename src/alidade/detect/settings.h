// What a detector's answers are held to.
#pragma once

#include <span>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning: Table() in settings.cc. The values are those of YOLOv5.
struct DetectorSettings {
  float min_score = 0.25f;
  float max_overlap = 0.45f;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
