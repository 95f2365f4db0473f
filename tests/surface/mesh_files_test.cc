#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/surface/mesh.h"
#include "support/expect_error.h"

namespace alidade::mesh_files_test {
namespace {

Mesh Square() {
  Mesh mesh;
  mesh.vertices.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}};
  mesh.vertices.normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh.vertices.colors = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {128, 128, 128}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

template <typename T>
T At(const std::string& bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST(MeshFiles, PlyHasVerticesAndFaces) {
  const std::string ply = EncodeMeshPly(Square());
  const size_t end = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("element vertex 4\n"), std::string::npos);
  EXPECT_NE(ply.find("element face 2\nproperty list uchar int vertex_indices\nend_header\n"),
            std::string::npos);
  ASSERT_EQ(ply.size(), end + 4 * 27 + 2 * 13);
  EXPECT_EQ(ply[end + 4 * 27], 3);
  EXPECT_EQ(At<uint32_t>(ply, end + 4 * 27 + 13 + 9), 3u);  // last index of the second face
}

TEST(MeshFiles, GlbIsGltf2) {
  const std::string glb = EncodeGlb(Square(), Eigen::Matrix3d::Identity());
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(At<uint32_t>(glb, 4), 2u);
  EXPECT_EQ(At<uint32_t>(glb, 8), glb.size());
  const uint32_t length = At<uint32_t>(glb, 12);
  EXPECT_EQ(length % 4, 0u);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  const auto json = nlohmann::json::parse(glb.substr(20, length));
  const size_t binary = 20 + length;
  EXPECT_EQ(glb.substr(binary + 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(At<uint32_t>(glb, binary), glb.size() - binary - 8);
  EXPECT_EQ(json["buffers"][0]["byteLength"], glb.size() - binary - 8);
  const auto& primitive = json["meshes"][0]["primitives"][0];
  const auto accessor = [&](int index) { return json["accessors"][static_cast<size_t>(index)]; };
  const auto position = accessor(primitive["attributes"]["POSITION"]);
  EXPECT_EQ(position["count"], 4);
  EXPECT_EQ(position["max"], (nlohmann::json{1, 1, 0.5}));
  const auto color = accessor(primitive["attributes"]["COLOR_0"]);
  const size_t at =
      binary + 8 +
      json["bufferViews"][static_cast<size_t>(color["bufferView"])]["byteOffset"].get<size_t>();
  EXPECT_EQ(At<uint16_t>(glb, at), 65535);                      // red is red in linear light, too
  EXPECT_NEAR(At<uint16_t>(glb, at + 24), 0.2159 * 65535, 30);  // sRGB 128 is 21.6 % of the light
  EXPECT_EQ(accessor(primitive["indices"])["count"], 6);
}

TEST(MeshFiles, GlbOfNothingIsRefused) {
  EXPECT_NE(MessageOf(ErrorKind::kUsage, [] { EncodeGlb({}, Eigen::Matrix3d::Identity()); })
                .find("triangle"),
            std::string::npos);
}

}  // namespace
}  // namespace alidade::mesh_files_test
