// Checks a YAML text before a document tree is built from it.
#pragma once

#include <string>

namespace alidade {

// Limits of YAML files. A camera file has about 30 values in 2 levels; a settings file about 150
// values.
inline constexpr int kMostYamlDepth = 16;     // levels of nested lists and maps
inline constexpr int kMostYamlNodes = 10000;  // keys, values, lists and maps

// Throws Error (input) with `name`:line when `text` is not valid YAML, exceeds the limits,
// repeats a key within a map, contains a second document, or uses anchors and aliases (`&a`, `*a`).
// Aliases could expand a few lines to millions of values or make a value contain itself.
void CheckYaml(const std::string& text, const std::string& name, int most_nodes = kMostYamlNodes);

}  // namespace alidade
