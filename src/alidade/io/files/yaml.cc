#include "alidade/io/files/yaml.h"

#include <cmath>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"

namespace alidade {

YamlFile::YamlFile(const std::string& path) : path_(path) {
  std::string text = ReadFile(path);
  if (text.rfind("%YAML:", 0) == 0) text[0] = '#';  // a comment keeps the line numbers
  try {
    root_ = YAML::Load(text);
  } catch (const YAML::ParserException& error) {
    ThrowInput(path + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
  if (!root_.IsMap()) ThrowInput(path + ": expected `name: value` lines");
}

void YamlFile::Fail(const YAML::Node& at, const std::string& what) const {
  const auto mark = at.Mark();
  ThrowInput(path_ + (mark.is_null() ? "" : ":" + std::to_string(mark.line + 1)) + ": " + what);
}

YAML::Node YamlFile::Need(const YAML::Node& parent, const std::string& key) const {
  const YAML::Node child = parent[key];
  if (!child || child.IsNull()) Fail(parent, "`" + key + "` is missing");
  return child;
}

double YamlFile::Number(const YAML::Node& node, const std::string& key) const {
  const auto number = node.IsScalar() ? ParseNumber(node.Scalar()) : std::nullopt;
  if (!number || !std::isfinite(*number)) {
    Fail(node, "`" + key + "` must be a finite number" +
                   (node.IsScalar() ? ", not `" + node.Scalar() + "`" : ""));
  }
  return *number;
}

int YamlFile::PositiveInteger(const YAML::Node& node, const std::string& key) const {
  const double number = Number(node, key);
  if (!(number >= 1 && number <= 100000) || number != std::floor(number)) {
    Fail(node,
         "`" + key + "` must be a whole number from 1 to 100000, not `" + node.Scalar() + "`");
  }
  return static_cast<int>(number);
}

std::string YamlFile::Text(const YAML::Node& node, const std::string& key) const {
  if (!node.IsScalar()) Fail(node, "`" + key + "` must be a word");
  return node.Scalar();
}

std::vector<double> YamlFile::Numbers(const YAML::Node& node, const std::string& key) const {
  if (!node.IsSequence()) Fail(node, "`" + key + "` must be a list of numbers");
  std::vector<double> numbers;
  for (const YAML::Node& item : node) {
    if (item.IsSequence()) {
      const auto row = Numbers(item, key);
      numbers.insert(numbers.end(), row.begin(), row.end());
    } else {
      numbers.push_back(Number(item, key));
    }
  }
  return numbers;
}

}  // namespace alidade
