// Decodes point clouds that EncodePly() wrote.
#include <cstring>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/io/cloud.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr size_t kMostPoints = 100'000'000;  // 1.6 GB in binary form

struct PlyLayout {
  bool binary = false;
  size_t count = 0;  // number of vertices
  bool colors = false, normals = false, sigmas = false;
  size_t body = 0;  // byte offset of the first vertex
  size_t Bytes() const { return 12 + (colors ? 3u : 0) + (normals ? 12u : 0) + (sigmas ? 4u : 0); }
};

PlyLayout LayoutOf(std::string_view bytes, const std::string& name) {
  const auto refuse = [&]() { ThrowInput(name + " is not a point cloud written by alidade"); };
  const size_t end = bytes.substr(0, 4096).find("end_header\n");
  if (bytes.substr(0, 4) != "ply\n" || end == std::string_view::npos) refuse();
  PlyLayout layout;
  layout.body = end + 11;
  std::istringstream header{std::string(bytes.substr(4, end - 4))};
  std::string line, properties;
  while (std::getline(header, line)) {
    const std::vector<std::string_view> words = Fields(line);
    if (words.size() == 3 && words[0] == "format") {
      layout.binary = words[1] == "binary_little_endian";
      if (!layout.binary && words[1] != "ascii") refuse();
    } else if (words.size() == 3 && words[0] == "element" && words[1] == "vertex") {
      const std::optional<double> count = ParseNumber(words[2]);
      if (!count || !(*count >= 0 && *count <= kMostPoints)) refuse();
      layout.count = static_cast<size_t>(*count);
    } else if (words.size() == 3 && words[0] == "property") {
      properties += std::string(words[1]) + " " + std::string(words[2]) + ";";
    } else if (words.empty() || words[0] != "comment") {
      refuse();
    }
  }
  // Properties in the order in which EncodePly() writes them; unknown ones are absent.
  std::string_view rest = properties;
  const auto next = [&](std::string_view what) {
    if (rest.substr(0, what.size()) != what) return false;
    rest.remove_prefix(what.size());
    return true;
  };
  if (!next("float x;float y;float z;")) refuse();
  layout.colors = next("uchar red;uchar green;uchar blue;");
  layout.normals = next("float nx;float ny;float nz;");
  layout.sigmas = next("float sigma;");
  if (!rest.empty()) refuse();
  return layout;
}

// Reads one number after the other, from text or from binary data.
class PlyNumbers {
 public:
  PlyNumbers(std::string_view bytes, bool binary) : bytes_(bytes), binary_(binary) {}
  float Float() {
    if (!binary_) return static_cast<float>(Word());
    float value = 0;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  uint8_t Byte() {
    if (!binary_) return static_cast<uint8_t>(Word());
    const auto value = static_cast<uint8_t>(bytes_[0]);
    bytes_.remove_prefix(1);
    return value;
  }
  bool bad() const { return bad_; }

 private:
  double Word() {
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(" \n"), bytes_.size()));
    const std::string_view word = bytes_.substr(0, bytes_.find_first_of(" \n"));
    bytes_.remove_prefix(word.size());
    const std::optional<double> value = ParseNumber(word);
    bad_ = bad_ || !value;
    return value.value_or(0);
  }
  std::string_view bytes_;
  bool binary_, bad_ = false;
};

}  // namespace

Cloud DecodePly(std::string_view bytes, const std::string& name) {
  const PlyLayout layout = LayoutOf(bytes, name);
  // A text line of three numbers has at least 6 bytes: a digit and a separator each.
  const size_t least = layout.binary ? layout.Bytes() : 6;
  const size_t left = bytes.size() - layout.body;
  if (left / least < layout.count) ThrowInput(name + " ends before its last point");
  PlyNumbers numbers(bytes.substr(layout.body), layout.binary);
  Cloud cloud;
  for (size_t i = 0; i < layout.count && !numbers.bad(); ++i) {
    const auto vector = [&] {
      const float x = numbers.Float(), y = numbers.Float();
      return Eigen::Vector3f(x, y, numbers.Float());
    };
    cloud.points.push_back(vector());
    if (layout.colors) {
      const uint8_t red = numbers.Byte(), green = numbers.Byte();
      cloud.colors.push_back({red, green, numbers.Byte()});
    }
    if (layout.normals) cloud.normals.push_back(vector());
    if (layout.sigmas) cloud.sigmas.push_back(numbers.Float());
  }
  if (numbers.bad()) ThrowInput(name + " contains a value that is not a number");
  return cloud;
}

}  // namespace alidade
