// What a detector's answers are held to.
#pragma once

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct DetectorSettings {
  float min_score = 0.25f;    // below, a detection is left out: what YOLOv5 itself runs with
  float max_overlap = 0.45f;  // of two of a class that share more (intersection over union) the
                              // better one stays: YOLOv5's too
  void Check() const;         // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
