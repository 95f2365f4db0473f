#include "alidade/io/cloud.h"

#include <bit>
#include <locale>
#include <sstream>

#include "alidade/base/error.h"

namespace alidade {
namespace {

void AppendLittleEndian(std::string& out, float value) {
  const auto bits = std::bit_cast<uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<char>((bits >> shift) & 0xff));
}

std::string Header(const Cloud& cloud, PlyFormat format) {
  std::string header = "ply\nformat ";
  header += format == PlyFormat::kAscii ? "ascii" : "binary_little_endian";
  header += " 1.0\nelement vertex " + std::to_string(cloud.points.size()) +
            "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!cloud.colors.empty())
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return header + "end_header\n";
}

}  // namespace

std::string EncodePly(const Cloud& cloud, PlyFormat format) {
  const bool colored = !cloud.colors.empty();
  if (colored && cloud.colors.size() != cloud.points.size()) {
    ThrowUsage("a cloud needs as many colours as points, or none");
  }
  std::string bytes = Header(cloud, format);
  if (format == PlyFormat::kBinary) {
    for (size_t i = 0; i < cloud.points.size(); ++i) {
      for (float value : {cloud.points[i].x(), cloud.points[i].y(), cloud.points[i].z()}) {
        AppendLittleEndian(bytes, value);
      }
      if (!colored) continue;
      for (uint8_t channel : cloud.colors[i]) bytes.push_back(static_cast<char>(channel));
    }
    return bytes;
  }
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);  // enough to bring each float back
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const auto& p = cloud.points[i];
    out << p.x() << ' ' << p.y() << ' ' << p.z();
    if (colored) {
      for (int channel : cloud.colors[i]) out << ' ' << channel;
    }
    out << '\n';
  }
  return bytes + out.str();
}

}  // namespace alidade
