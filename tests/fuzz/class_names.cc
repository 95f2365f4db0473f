#include "alidade/detect/class_names.h"

#include "fuzz/targets.h"

namespace alidade::fuzz {

void ClassNames(std::string_view bytes) {
  const auto given = ParseClassNames(bytes);
  for (const int classes : {0, 1, 80}) {
    const auto names = NamesFor(classes, given);
    Expect(!names.empty() && (classes == 0 || names.size() == static_cast<size_t>(classes)),
           "another number of names than of classes");
    for (const std::string& name : names) Expect(!name.empty(), "a class without a name");
  }
}

}  // namespace alidade::fuzz
