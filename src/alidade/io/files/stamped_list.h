// Lists of time stamps with what was taken then: rgb.txt, data.csv, times.txt.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace alidade {

struct StampedName {
  double time = 0;    // seconds; meaningless with a problem
  std::string stamp;  // as written
  std::string name;   // what follows the stamp: a file's name, perhaps with a folder; may be empty
  std::string problem;  // not empty: the line cannot be used, and why (file:line)
};

enum class StampUnit { kSeconds, kNanoseconds };

// In the file's order. Lines whose stamp is no finite number, or without a name where one is
// wanted, have a problem. Throws Error when the file cannot be read or holds no lines.
std::vector<StampedName> ReadStampedList(const std::string& path, StampUnit unit, bool with_names);
// The same of a file's text; `name` is what it is called in errors.
std::vector<StampedName> ParseStampedList(std::string_view text, const std::string& name,
                                          StampUnit unit, bool with_names);

}  // namespace alidade
