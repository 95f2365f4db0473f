// The list `alidade batch` works through: a recording per line, with options as after `alidade
// run`.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace alidade {

// The words of a line as a shell would have them: blanks part them, '…' and "…" keep them together,
// \ takes the next sign as it is, # begins a comment at the start of a word, ~/ is the home folder,
// $NAME and ${NAME} are of the environment (not within '…'). Nothing else is special: & and ? of
// synth: need no quotes. Throws Error (usage), for an open quote or a name that is not set.
std::vector<std::string> WordsOfLine(const std::string& line);

struct BatchItem {
  std::string name;                // of its folder of results, within --out
  std::vector<std::string> words;  // after `alidade run`, without --out
  int line = 0;                    // in the list, from 1
};

// `more`: words added to every line. A line's `--out NAME` names its folder; else that is what the
// source is called, with -2, -3, … where that is taken, by another line or by results of another
// source (`is_others`, of folder name and source). Throws Error (usage), beginning with
// `name`:LINE, for a line that cannot be read, a name that is taken or is no plain name; and for a
// list without lines. Options are not looked at here.
using IsOthersFolder = std::function<bool(const std::string& name, const std::string& source)>;
std::vector<BatchItem> ParseBatchList(const std::string& text, const std::string& name,
                                      const std::vector<std::string>& more,
                                      const IsOthersFolder& is_others = nullptr);

// The source among the words: what is no option and no option's value is not known here, so it is
// the first word, which must be the source.
inline const std::string& SourceOf(const BatchItem& item) { return item.words.front(); }

// A line that gives these words again.
std::string LineOf(const BatchItem& item);

}  // namespace alidade
