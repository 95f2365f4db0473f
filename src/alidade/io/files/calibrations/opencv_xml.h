// The XML that cv::FileStorage writes, as YAML.
#pragma once

#include <string>

namespace alidade {

// Converts elements to maps and lists in YAML's flow style, line by line, so that line numbers stay
// those of the file. Text of several numbers becomes a list. Throws Error (input) with `name`:line.
std::string YamlOfOpenCvXml(const std::string& text, const std::string& name);

}  // namespace alidade
