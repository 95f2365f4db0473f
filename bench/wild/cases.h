// The rendered recordings of `alidade-bench wild`: what a user's own video may be like.
#pragma once

#include <string>
#include <vector>

namespace alidade::bench {

struct WildCase {
  std::string name;    // for --cases
  std::string source;  // synth:…, without the seed
  std::string profile = "desktop";
  // False: there is nothing a map could be made of with one camera, and none should be.
  bool map = true;
};

// All there are, or those named (with commas between them; "" for all). Throws Error (usage) for a
// name there is not.
std::vector<WildCase> WildCases(const std::string& names);

}  // namespace alidade::bench
