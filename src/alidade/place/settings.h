// What place recognition can be told.
#pragma once

#include "alidade/base/api.h"
#include "alidade/place/vocabulary.h"
#include "alidade/place/word_matching.h"

namespace ALIDADE_API alidade {

struct PlaceSettings {
  VocabularySettings vocabulary;
  WordMatchSettings matching;
  int sample = 30000;  // descriptors a vocabulary is grown from at most, the same number of each
                       // keyframe: four times as many take longer and find no more
  int shortlist = 20;  // keyframes whose words are likest, that are then matched: three times as
                       // many find 1 % more revisits in a real kitchen, half as many 2 % fewer
  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
