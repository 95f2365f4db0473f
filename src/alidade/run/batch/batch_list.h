// The list of `alidade batch`: one recording per line, with options as for `alidade run`.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace alidade {

// Splits a line into words as a shell does: blanks separate words, '…' and "…" keep them together,
// \ quotes the next character, # at the start of a word begins a comment, ~/ is the home folder,
// $NAME and ${NAME} are environment variables (not within '…'). Nothing else is special: & and ? of
// synth: need no quotes. Throws Error (usage) for an unclosed quote or an unset variable.
std::vector<std::string> WordsOfLine(const std::string& line);

struct BatchItem {
  std::string name;                // name of the result folder within --out
  std::vector<std::string> words;  // arguments of `alidade run`, without --out
  int line = 0;                    // line number in the list, from 1
};

// `more`: words added to every line. `--out NAME` of a line names its folder; the default is the
// name of the source, followed by -2, -3, … if another line, or a result of another source
// (`is_others`, called with folder name and source), has that name. Throws Error (usage), beginning
// with `name`:LINE, for a line that cannot be parsed and for a name that is taken or contains a
// path; also for an empty list. Options are not checked here.
using IsOthersFolder = std::function<bool(const std::string& name, const std::string& source)>;
std::vector<BatchItem> ParseBatchList(const std::string& text, const std::string& name,
                                      const std::vector<std::string>& more,
                                      const IsOthersFolder& is_others = nullptr);

// The source of an item: its first word, since options and their values are not known here.
inline const std::string& SourceOf(const BatchItem& item) { return item.words.front(); }

// A line that parses to these words.
std::string LineOf(const BatchItem& item);

}  // namespace alidade
