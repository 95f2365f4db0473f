#include "alidade/io/cloud.h"

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
  for (float value : {p.x(), p.y(), p.z()})
    AppendLittleEndian(out, Eigen::numext::bit_cast<uint32_t>(value));
}

std::ostringstream FloatText() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);  // max_digits10 of float: reads back exactly
  return out;
}

void CheckLengths(const Cloud& cloud) {
  for (const size_t length : {cloud.colors.size(), cloud.normals.size(), cloud.sigmas.size()}) {
    if (length != 0 && length != cloud.points.size())
      ThrowUsage("a cloud must have as many colors, normals and sigmas as points, or none");
  }
}

// Writes normal and sigma of point i, which follow position and color, and returns their count.
size_t FloatsBehind(const Cloud& cloud, size_t i, std::array<float, 4>& floats) {
  size_t count = 0;
  if (!cloud.normals.empty()) {
    for (int axis = 0; axis < 3; ++axis) floats[count++] = cloud.normals[i][axis];
  }
  if (!cloud.sigmas.empty()) floats[count++] = cloud.sigmas[i];
  return count;
}

std::string PlyHeader(const Cloud& cloud, CloudFormat format) {
  std::string header = "ply\nformat ";
  header += format == CloudFormat::kAscii ? "ascii" : "binary_little_endian";
  header += " 1.0\nelement vertex " + std::to_string(cloud.points.size()) +
            "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!cloud.colors.empty())
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!cloud.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!cloud.sigmas.empty()) header += "property float sigma\n";
  return header + "end_header\n";
}

std::string PcdHeader(const Cloud& cloud, CloudFormat format) {
  std::string fields = "x y z", types = "F F F";
  if (!cloud.colors.empty()) {
    fields += " rgb";
    types += " U";
  }
  if (!cloud.normals.empty()) {
    fields += " normal_x normal_y normal_z";
    types += " F F F";
  }
  if (!cloud.sigmas.empty()) {
    fields += " sigma";
    types += " F";
  }
  std::string sizes = types, counts = types;
  for (size_t i = 0; i < types.size(); i += 2) {
    sizes[i] = '4';
    counts[i] = '1';
  }
  const std::string count = std::to_string(cloud.points.size());
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " +
         sizes + "\nTYPE " + types + "\nCOUNT " + counts + "\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " +
         (format == CloudFormat::kAscii ? "ascii\n" : "binary\n");
}

// One integer 0x00RRGGBB, as PCL stores colors.
uint32_t Packed(const std::array<uint8_t, 3>& rgb) {
  return static_cast<uint32_t>(rgb[0]) << 16 | static_cast<uint32_t>(rgb[1]) << 8 | rgb[2];
}

// PLY stores the three channels separately, PCD packs them into one number.
enum class Channels { kApart, kPacked };

std::string BinaryPoints(const Cloud& cloud, Channels channels) {
  std::string bytes;
  std::array<float, 4> floats{};
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    AppendLittleEndian(bytes, cloud.points[i]);
    if (!cloud.colors.empty() && channels == Channels::kPacked) {
      AppendLittleEndian(bytes, Packed(cloud.colors[i]));
    } else if (!cloud.colors.empty()) {
      for (uint8_t channel : cloud.colors[i]) bytes.push_back(static_cast<char>(channel));
    }
    const size_t count = FloatsBehind(cloud, i, floats);
    for (size_t k = 0; k < count; ++k)
      AppendLittleEndian(bytes, Eigen::numext::bit_cast<uint32_t>(floats[k]));
  }
  return bytes;
}

std::string TextPoints(const Cloud& cloud, Channels channels) {
  std::ostringstream out = FloatText();
  std::array<float, 4> floats{};
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    out << p.x() << ' ' << p.y() << ' ' << p.z();
    if (!cloud.colors.empty() && channels == Channels::kPacked) {
      out << ' ' << Packed(cloud.colors[i]);
    } else if (!cloud.colors.empty()) {
      for (int channel : cloud.colors[i]) out << ' ' << channel;
    }
    const size_t count = FloatsBehind(cloud, i, floats);
    for (size_t k = 0; k < count; ++k) out << ' ' << floats[k];
    out << '\n';
  }
  return out.str();
}

std::string Points(const Cloud& cloud, CloudFormat format, Channels channels) {
  return format == CloudFormat::kBinary ? BinaryPoints(cloud, channels)
                                        : TextPoints(cloud, channels);
}

}  // namespace

std::string EncodePly(const Cloud& cloud, CloudFormat format) {
  CheckLengths(cloud);
  return PlyHeader(cloud, format) + Points(cloud, format, Channels::kApart);
}

std::string EncodePcd(const Cloud& cloud, CloudFormat format) {
  CheckLengths(cloud);
  return PcdHeader(cloud, format) + Points(cloud, format, Channels::kPacked);
}

}  // namespace alidade
