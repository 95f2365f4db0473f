// Rendered recordings like the videos users have: the table "In the wild" of
// docs/benchmarks/robustness.md.
#pragma once

#include <string>
#include <vector>

namespace alidade::bench {

struct WildOptions {
  std::string cases;                  // names with commas between them; "": all
  std::string profile;                // of all cases; "": each its own
  std::vector<std::string> settings;  // name=value, of every run
  int seeds = 3;
  int frames = 0;      // of each, at most; 0: all the case has
  bool check = false;  // say so when there is a false pose or a false map
  std::string out;     // JSON file; "": none
};

// Prints the table. Returns the exit status: 1 when `check` finds something, else 0.
int BenchWild(const WildOptions& options);

}  // namespace alidade::bench
