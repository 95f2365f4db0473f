#include "alidade/io/cloud.h"

#include <bit>
#include <locale>
#include <sstream>

#include "alidade/base/error.h"

namespace alidade {
namespace {

void AppendLittleEndian(std::string& out, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) {
    out.push_back(static_cast<char>((value >> shift) & 0xff));
  }
}

void AppendLittleEndian(std::string& out, const Eigen::Vector3f& p) {
  for (float value : {p.x(), p.y(), p.z()}) AppendLittleEndian(out, std::bit_cast<uint32_t>(value));
}

std::ostringstream Text() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);  // enough to bring each float back
  return out;
}

bool HasColors(const Cloud& cloud) {
  if (cloud.colors.empty()) return false;
  if (cloud.colors.size() != cloud.points.size()) {
    ThrowUsage("a cloud needs as many colours as points, or none");
  }
  return true;
}

std::string PlyHeader(const Cloud& cloud, CloudFormat format) {
  std::string header = "ply\nformat ";
  header += format == CloudFormat::kAscii ? "ascii" : "binary_little_endian";
  header += " 1.0\nelement vertex " + std::to_string(cloud.points.size()) +
            "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!cloud.colors.empty())
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return header + "end_header\n";
}

std::string PcdHeader(const Cloud& cloud, CloudFormat format) {
  const bool colored = !cloud.colors.empty();
  const std::string count = std::to_string(cloud.points.size());
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n";
  header += colored ? "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
                    : "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  header += "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA ";
  return header + (format == CloudFormat::kAscii ? "ascii\n" : "binary\n");
}

// As PCL packs a colour into one number.
uint32_t Packed(const std::array<uint8_t, 3>& rgb) {
  return static_cast<uint32_t>(rgb[0]) << 16 | static_cast<uint32_t>(rgb[1]) << 8 | rgb[2];
}

}  // namespace

std::string EncodePly(const Cloud& cloud, CloudFormat format) {
  const bool colored = HasColors(cloud);
  std::string bytes = PlyHeader(cloud, format);
  std::ostringstream out = Text();
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    if (format == CloudFormat::kBinary) {
      AppendLittleEndian(bytes, p);
      if (!colored) continue;
      for (uint8_t channel : cloud.colors[i]) bytes.push_back(static_cast<char>(channel));
      continue;
    }
    out << p.x() << ' ' << p.y() << ' ' << p.z();
    if (colored) {
      for (int channel : cloud.colors[i]) out << ' ' << channel;
    }
    out << '\n';
  }
  return bytes + out.str();
}

std::string EncodePcd(const Cloud& cloud, CloudFormat format) {
  const bool colored = HasColors(cloud);
  std::string bytes = PcdHeader(cloud, format);
  std::ostringstream out = Text();
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    if (format == CloudFormat::kBinary) {
      AppendLittleEndian(bytes, p);
      if (colored) AppendLittleEndian(bytes, Packed(cloud.colors[i]));
      continue;
    }
    out << p.x() << ' ' << p.y() << ' ' << p.z();
    if (colored) out << ' ' << Packed(cloud.colors[i]);
    out << '\n';
  }
  return bytes + out.str();
}

}  // namespace alidade
