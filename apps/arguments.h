// What the subcommands share about words on the command line.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace CLI {
class App;
}

namespace alidade {

// Throws Error (usage), with the nearest known name, for the first subcommand or --option that is
// not known. Done before the real parse, whose own complaint might be about something that follows
// from the slip.
void CheckNames(const CLI::App& app, const std::vector<std::string>& arguments);

// More threads than cores only wait for each other, and each has 8 MB of stack to its name; no
// machine this is meant for has as many cores.
inline constexpr int kMostThreads = 256;
// Of --threads: throws Error (usage) for a number that cannot be.
void CheckThreads(int threads);

// The value a word stands for, e.g. Choice("--align", word, {{"se3", kSe3}, {"sim3", kSim3}}).
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
