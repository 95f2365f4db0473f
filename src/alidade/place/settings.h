// What place recognition can be told.
#pragma once

#include "alidade/place/vocabulary.h"

namespace alidade {

struct PlaceSettings {
  VocabularySettings vocabulary;
  int sample = 60000;  // descriptors a vocabulary is grown from at most, the same number of each
                       // keyframe: more take longer and part the words no better
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
