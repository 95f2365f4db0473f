// What place recognition can be told.
#pragma once

#include <span>

#include "alidade/base/api.h"
#include "alidade/place/vocabulary.h"
#include "alidade/place/word_matching.h"

namespace ALIDADE_API alidade {

struct Setting;

// Range, unit and meaning of the named fields: Table() in settings.cc.
struct PlaceSettings {
  VocabularySettings vocabulary;
  WordMatchSettings matching;
  // Most descriptors from which a vocabulary is grown, the same number of each keyframe. Four times
  // as many take longer and find no more.
  int sample = 30000;
  // Three times as many find 1 % more revisits, half as many 2 % fewer.
  int shortlist = 20;
  static std::span<const Setting> Table();
  void Check() const;  // throws Error (usage) naming the invalid setting
};

}  // namespace alidade
