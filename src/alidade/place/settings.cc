#include "alidade/place/settings.h"

#include "alidade/base/error.h"
#include "alidade/base/settings_table.h"

namespace alidade {

std::span<const Setting> PlaceSettings::Table() {
  using T = PlaceSettings;
  using V = VocabularySettings;
  static constexpr Setting kRows[] = {
      ExpertSetting<&T::vocabulary, &V::branching>(
          "places.branching", FromTo(2, Vocabulary::kMaxChildren), "",
          "Most children of a node of the vocabulary tree."),
      ExpertSetting<&T::vocabulary, &V::levels>(
          "places.levels", FromTo(1, Vocabulary::kMaxLevels), "",
          "Levels of the vocabulary tree: at most branching^levels words."),
      ExpertSetting<&T::shortlist>("places.shortlist", kPositive, "keyframes",
                                   "Keyframes with the most similar words whose descriptors are "
                                   "matched."),
  };
  return kRows;
}

void PlaceSettings::Check() const {
  CheckRanges(*this);
  vocabulary.Check();
  matching.Check();
}

}  // namespace alidade
