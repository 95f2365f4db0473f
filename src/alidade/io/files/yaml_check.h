// A look through a YAML text before anything is built of it.
#pragma once

#include <string>

namespace alidade {

// What a file of ours can need. A camera file has some 30 values two deep, the settings some 150.
inline constexpr int kMostYamlDepth = 16;     // lists and maps in one another
inline constexpr int kMostYamlNodes = 10000;  // names, values, lists and maps

// Throws Error (input) with `name`:line when `text` is no YAML, goes deeper or holds more than the
// above, gives a name twice in one map, holds a second document, or uses anchors and aliases (`&a`
// and `*a`): by these a few lines stand for millions of values, or for one that holds itself.
void CheckYaml(const std::string& text, const std::string& name);

}  // namespace alidade
