// A result as a JSON file: what docs/benchmarks/index.md is made from (bench/README.md has the fields).
#pragma once

#include <string>
#include <vector>

#include "bench/measure/result.h"

namespace alidade::bench {

// Writes {benchmark, commit, date, machine, u_ms, rows}. An empty path: nowhere.
void WriteResult(const std::string& path, const std::string& benchmark,
                 const std::vector<Section>& sections);

}  // namespace alidade::bench
