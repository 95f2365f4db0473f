#include "alidade/io/files/yaml.h"

#include <cmath>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"

namespace alidade {

namespace {

// Shortens text for error messages.
std::string Start(const std::string& text) {
  constexpr size_t kEnough = 60;
  return text.size() <= kEnough ? text : text.substr(0, kEnough) + "...";
}

}  // namespace

YamlFile::YamlFile(const std::string& path) : YamlFile(ReadFile(path, kMostConfigBytes), path) {}

YamlFile::YamlFile(std::string text, const std::string& name, int most_nodes) : path_(name) {
  if (text.rfind("%YAML:", 0) == 0) text[0] = '#';  // as a comment it does not shift line numbers
  CheckYaml(text, name, most_nodes);
  try {
    root_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    ThrowInput(name + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
  if (root_.IsNull()) root_ = YAML::Node(YAML::NodeType::Map);
  if (!root_.IsMap()) ThrowInput(name + ": expected `name: value` lines");
}

void YamlFile::Fail(const YAML::Node& at, const std::string& what) const {
  const auto mark = at.Mark();
  ThrowInput(path_ + (mark.is_null() ? "" : ":" + std::to_string(mark.line + 1)) + ": " +
             (tool_.empty() ? "" : tool_ + ": ") + what);
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
                   (node.IsScalar() ? ", not `" + Start(node.Scalar()) + "`" : ""));
  }
  return *number;
}

int YamlFile::PositiveInteger(const YAML::Node& node, const std::string& key) const {
  const double number = Number(node, key);
  if (!(number >= 1 && number <= 100000) || number != std::floor(number)) {
    Fail(node, "`" + key + "` must be a whole number from 1 to 100000, not `" +
                   Start(node.Scalar()) + "`");
  }
  return static_cast<int>(number);
}

void YamlFile::CheckSize(const YAML::Node& at, int width, int height) const {
  if (!IsPictureSize(width, height)) Fail(at, TooLargeText(width, height));
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

Se3 YamlFile::Transform(const YAML::Node& node, const std::string& key) const {
  return Transform(node, key, Numbers(node, key));
}

Se3 YamlFile::Transform(const YAML::Node& node, const std::string& key,
                        const std::vector<double>& v) const {
  if (v.size() != 16) Fail(node, "`" + key + "` must be 4x4 numbers, row by row");
  Se3 T;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T.R(r, c) = v[static_cast<size_t>(4 * r + c)];
    T.t[r] = v[static_cast<size_t>(4 * r + 3)];
  }
  if (!((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm() <= 1e-2) ||
      T.R.determinant() < 0) {
    Fail(node, "`" + key + "`: the upper left 3x3 part is not a rotation");
  }
  return T.Normalised();
}

}  // namespace alidade
