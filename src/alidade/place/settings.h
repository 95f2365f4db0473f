// What place recognition can be told.
#pragma once

#include "alidade/place/vocabulary.h"
#include "alidade/place/word_matching.h"

namespace alidade {

struct PlaceSettings {
  VocabularySettings vocabulary;
  WordMatchSettings matching;
  int sample = 60000;  // descriptors a vocabulary is grown from at most, the same number of each
                       // keyframe: more take longer and part the words no better
  int shortlist = 30;  // keyframes whose words are likest, that are then matched; half as many miss
                       // one revisit in fifty of a real kitchen
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
