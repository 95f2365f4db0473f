// What a bench measured, as lines of a terminal and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench.h"

namespace alidade::bench {

void PrintSection(const Section& section);
nlohmann::ordered_json SectionJson(const Section& section);

// `all`: what holds for all benches. An empty path: nowhere.
void WriteSections(const std::string& path, nlohmann::ordered_json all,
                   nlohmann::ordered_json sections);

}  // namespace alidade::bench
