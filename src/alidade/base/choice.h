// Words that stand for values.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade {

// The value a word stands for, e.g. Choice("--align", word, {{"se3", kSe3}, {"sim3", kSim3}}).
// Throws Error (usage) with the nearest that there is; `option` is whose word it is.
template <typename T>
T Choice(const std::string& option, const std::string& word,
         const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> words;
  std::string list;
  for (const auto& [name, value] : choices) {
    if (name == word) return value;
    words.push_back(name);
    list += (list.empty() ? "" : ", ") + name;
  }
  ThrowUsage(option + " cannot be '" + word + "' (it is one of " + list + ")" +
             DidYouMean(word, words));
}

}  // namespace alidade
