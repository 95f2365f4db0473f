// YAML nodes with errors that name the file and the line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "alidade/geometry/se3.h"

namespace alidade {

class YamlFile {
 public:
  // Throws Error (input): see CheckYaml(). An empty file is an empty map.
  explicit YamlFile(const std::string& path);
  // The same for text that is `name` in errors. Takes OpenCV's `%YAML:1.0` first line too, which
  // YAML itself does not know.
  YamlFile(std::string text, const std::string& name);

  const YAML::Node& root() const { return root_; }
  const std::string& path() const { return path_; }

  [[noreturn]] void Fail(const YAML::Node& at, const std::string& what) const;
  // The child `key`; throws when it is missing.
  YAML::Node Need(const YAML::Node& parent, const std::string& key) const;
  double Number(const YAML::Node& node, const std::string& key) const;  // finite
  int PositiveInteger(const YAML::Node& node, const std::string& key) const;
  // Throws when no picture can be that large (see kMostPixels in picture_size.h).
  void CheckSize(const YAML::Node& at, int width, int height) const;
  std::string Text(const YAML::Node& node, const std::string& key) const;
  // A flat list, or a list of lists flattened row by row.
  std::vector<double> Numbers(const YAML::Node& node, const std::string& key) const;
  // 16 numbers, the rows of a 4x4 matrix whose upper left part is a rotation.
  Se3 Transform(const YAML::Node& node, const std::string& key) const;

 private:
  std::string path_;
  YAML::Node root_;
};

}  // namespace alidade
