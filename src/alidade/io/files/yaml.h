// YAML files with errors that name the file and the line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/io/files/yaml_check.h"

namespace alidade {

class YamlFile {
 public:
  // Throws Error (input); see CheckYaml() for the limits. An empty file is an empty map.
  explicit YamlFile(const std::string& path);
  // The same for a text; `name` appears in errors. Accepts OpenCV's first line `%YAML:1.0`, which
  // is not valid YAML.
  // `most_nodes`: see CheckYaml().
  YamlFile(std::string text, const std::string& name, int most_nodes = kMostYamlNodes);

  const YAML::Node& root() const { return root_; }
  const std::string& path() const { return path_; }
  // Messages of Fail() begin with this name of the tool that wrote the file.
  void SetTool(const std::string& tool) { tool_ = tool; }

  [[noreturn]] void Fail(const YAML::Node& at, const std::string& what) const;
  // The child `key`; throws Error (input) when it is missing.
  YAML::Node Need(const YAML::Node& parent, const std::string& key) const;
  double Number(const YAML::Node& node, const std::string& key) const;  // a finite number
  int PositiveInteger(const YAML::Node& node, const std::string& key) const;
  // Throws Error (input) when the size exceeds the limits of picture_size.h.
  void CheckSize(const YAML::Node& at, int width, int height) const;
  std::string Text(const YAML::Node& node, const std::string& key) const;
  // A list of numbers; a list of lists is flattened row by row.
  std::vector<double> Numbers(const YAML::Node& node, const std::string& key) const;
  // A 4x4 matrix as 16 numbers, row-major; the upper left 3x3 part must be a rotation.
  Se3 Transform(const YAML::Node& node, const std::string& key) const;
  // The same for the 16 numbers of `at`.
  Se3 Transform(const YAML::Node& at, const std::string& key, const std::vector<double>& v) const;

 private:
  std::string path_, tool_;
  YAML::Node root_;
};

}  // namespace alidade
