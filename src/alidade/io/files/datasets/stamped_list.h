// Lists of time stamps with file names: rgb.txt, data.csv, times.txt.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "alidade/io/stamp_unit.h"

namespace alidade {

struct StampedName {
  double time = 0;      // seconds; undefined when there is a problem
  std::string stamp;    // time as text in seconds
  std::string name;     // rest of the line: a file name, possibly with a folder; may be empty
  std::string problem;  // why the line cannot be used (file:line); empty: no problem
};

// Whether a list's unit is that of its format, or the most probable one (ProbableUnit()).
enum class FindUnit { kNo, kYes };

// Returns the lines in the file's order. A line whose stamp is not a finite number, or that lacks a
// required name, gets a problem. `unit` is that of the format; for a camera's images,
// FindUnit::kYes reads a list in another unit, with a warning. Throws Error (input) when the file
// cannot be read or has no lines.
std::vector<StampedName> ReadStampedList(const std::string& path, StampUnit unit, bool with_names,
                                         FindUnit find = FindUnit::kNo);
// The same for a file's text; `name` appears in errors.
std::vector<StampedName> ParseStampedList(std::string_view text, const std::string& name,
                                          StampUnit unit, bool with_names,
                                          FindUnit find = FindUnit::kNo);

}  // namespace alidade
