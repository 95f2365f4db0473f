// Encodes meshes as PLY and GLB.
#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/surface/mesh.h"

namespace alidade {
namespace {

template <typename Unsigned>
void AppendBytes(std::string& out, Unsigned value) {
  for (size_t i = 0; i < sizeof value; ++i)
    out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

void AppendFloats(std::string& out, const Eigen::Vector3f& v) {
  for (const float value : {v.x(), v.y(), v.z()}) AppendBytes(out, std::bit_cast<uint32_t>(value));
}

// glTF's vertex colors are proportional to light; those of images are sRGB (IEC 61966-2-1).
uint16_t LinearOf(uint8_t value) {
  const double s = value / 255.0;
  const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<uint16_t>(std::lround(65535 * linear));
}

std::string TextOf(const Eigen::VectorXd& values) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  out << '[';
  for (int i = 0; i < values.size(); ++i) out << (i > 0 ? "," : "") << values[i];
  out << ']';
  return out.str();
}

// The binary part of a GLB, and its description.
class GlbParts {
 public:
  explicit GlbParts(const Mesh& mesh) {
    const Cloud& vertices = mesh.vertices;
    Eigen::Vector3f low = vertices.points[0], high = low;
    for (const Eigen::Vector3f& p : vertices.points) {
      AppendFloats(bytes_, p);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    End("POSITION", vertices.points.size(), 5126, "VEC3",
        ",\"min\":" + TextOf(low.cast<double>()) + ",\"max\":" + TextOf(high.cast<double>()));
    for (const Eigen::Vector3f& n : vertices.normals) AppendFloats(bytes_, n);
    End("NORMAL", vertices.normals.size(), 5126, "VEC3");
    for (const auto& rgb : vertices.colors) {
      for (const uint8_t channel : rgb) AppendBytes(bytes_, LinearOf(channel));
      AppendBytes(bytes_, uint16_t{65535});  // opaque; keeps vertices at multiples of 4 bytes
    }
    End("COLOR_0", vertices.colors.size(), 5123, "VEC4", ",\"normalized\":true");
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t index : triangle) AppendBytes(bytes_, index);
    }
    End("", 3 * mesh.triangles.size(), 5125, "SCALAR");
  }
  const std::string& bytes() const { return bytes_; }
  std::string Json(const Eigen::Matrix3d& R_up) const {
    const Eigen::Quaterniond q(R_up);
    return R"({"asset":{"version":"2.0","generator":"alidade"},"scene":0,)"
           R"("extensionsUsed":["KHR_materials_unlit"],"scenes":[{"nodes":[0]}],)"
           R"("nodes":[{"mesh":0,"rotation":)" +
           TextOf(q.normalized().coeffs()) +
           R"(}],"materials":[{"doubleSided":true,"pbrMetallicRoughness":{"metallicFactor":0},)"
           R"("extensions":{"KHR_materials_unlit":{}}}],"meshes":[{"primitives":[{"material":0,)"
           R"("attributes":{)" +
           attributes_ + R"(},"indices":)" + std::to_string(count_ - 1) + R"(}]}],"accessors":[)" +
           accessors_ + R"(],"bufferViews":[)" + views_ + R"(],"buffers":[{"byteLength":)" +
           std::to_string(bytes_.size()) + "}]}";
  }

 private:
  // Describes what was appended since the last call; an attribute without elements is left out.
  void End(const char* attribute, size_t elements, int component, const char* type,
           const std::string& more = "") {
    if (elements == 0) return;
    const bool is_attribute = *attribute != '\0';
    if (is_attribute)
      attributes_ +=
          (count_ > 0 ? ",\"" : "\"") + std::string(attribute) + "\":" + std::to_string(count_);
    const std::string comma = count_ > 0 ? "," : "";
    accessors_ += comma + "{\"bufferView\":" + std::to_string(count_) +
                  ",\"componentType\":" + std::to_string(component) +
                  ",\"count\":" + std::to_string(elements) + ",\"type\":\"" + type + "\"" + more +
                  "}";
    views_ += comma + "{\"buffer\":0,\"byteOffset\":" + std::to_string(start_) +
              ",\"byteLength\":" + std::to_string(bytes_.size() - start_) +
              ",\"target\":" + (is_attribute ? "34962" : "34963") + "}";
    start_ = bytes_.size();
    ++count_;
  }

  std::string bytes_, attributes_, accessors_, views_;
  size_t start_ = 0;
  int count_ = 0;
};

}  // namespace

std::string EncodeMeshPly(const Mesh& mesh) {
  std::string ply = EncodePly(mesh.vertices, CloudFormat::kBinary);
  const std::string end = "end_header\n";
  ply.insert(ply.find(end), "element face " + std::to_string(mesh.triangles.size()) +
                                "\nproperty list uchar int vertex_indices\n");
  for (const auto& triangle : mesh.triangles) {
    ply.push_back(3);
    for (const uint32_t index : triangle) AppendBytes(ply, index);
  }
  return ply;
}

std::string EncodeGlb(const Mesh& mesh, const Eigen::Matrix3d& R_up) {
  if (mesh.triangles.empty()) ThrowUsage("a GLB file needs at least one triangle");
  const GlbParts parts(mesh);
  std::string json = parts.Json(R_up);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t total = 12 + 8 + json.size() + 8 + parts.bytes().size();
  if (total > std::numeric_limits<uint32_t>::max())
    ThrowUsage("a GLB file holds 4 GiB at most: choose larger voxels");
  std::string glb = "glTF";
  AppendBytes(glb, uint32_t{2});
  AppendBytes(glb, static_cast<uint32_t>(total));
  AppendBytes(glb, static_cast<uint32_t>(json.size()));
  glb += "JSON" + json;
  AppendBytes(glb, static_cast<uint32_t>(parts.bytes().size()));
  glb += std::string("BIN\0", 4) + parts.bytes();
  return glb;
}

}  // namespace alidade
