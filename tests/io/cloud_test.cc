#include "alidade/io/cloud.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

namespace alidade {
namespace {

const Cloud kCloud{{{1.5f, -2, 0.1f}, {1e-7f, 3e8f, -0.f}}, {{255, 0, 7}, {1, 2, 3}}};

TEST(Ply, AsciiReadsBackToTheSameFloats) {
  std::istringstream in(EncodePly(kCloud, CloudFormat::kAscii));
  std::string line, header;
  while (std::getline(in, line) && line != "end_header") header += line + "\n";
  EXPECT_EQ(header,
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
            "float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n");
  for (size_t i = 0; i < 2; ++i) {
    Eigen::Vector3f p;
    int r = 0, g = 0, b = 0;
    in >> p.x() >> p.y() >> p.z() >> r >> g >> b;
    EXPECT_EQ(p, kCloud.points[i]);
    EXPECT_EQ((std::array<uint8_t, 3>{static_cast<uint8_t>(r), static_cast<uint8_t>(g),
                                      static_cast<uint8_t>(b)}),
              kCloud.colors[i]);
  }
}

TEST(Ply, BinaryHoldsTheBytesOfTheFloats) {
  const std::string bytes = EncodePly({kCloud.points, {}}, CloudFormat::kBinary);
  const size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 24);
  float value = 0;
  std::memcpy(&value, bytes.data() + body + 12, 4);  // the machines we test on are little endian
  EXPECT_EQ(value, 1e-7f);
  EXPECT_EQ(bytes.find("red"), std::string::npos);
  EXPECT_EQ(EncodePly(kCloud, CloudFormat::kBinary)
                .substr(EncodePly(kCloud, CloudFormat::kBinary).size() - 3),
            "\1\2\3");
}

// Header and body of a PCD file, as the format's description has it.
std::pair<std::string, std::string> SplitPcd(const std::string& bytes) {
  const size_t data = bytes.find("\nDATA ");
  EXPECT_NE(data, std::string::npos);
  const size_t body = bytes.find('\n', data + 1) + 1;
  return {bytes.substr(0, body), bytes.substr(body)};
}

TEST(Pcd, AsciiReadsBackToTheSameFloats) {
  const auto [header, body] = SplitPcd(EncodePcd(kCloud, CloudFormat::kAscii));
  EXPECT_EQ(header,
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\n"
            "SIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n");
  std::istringstream in(body);
  for (size_t i = 0; i < 2; ++i) {
    Eigen::Vector3f p;
    uint32_t rgb = 0;
    in >> p.x() >> p.y() >> p.z() >> rgb;
    EXPECT_EQ(p, kCloud.points[i]);
    EXPECT_EQ(rgb, 65536u * kCloud.colors[i][0] + 256u * kCloud.colors[i][1] + kCloud.colors[i][2]);
  }
}

TEST(Pcd, BinaryHoldsTheBytesOfTheFields) {
  const auto [plain, coordinates] = SplitPcd(EncodePcd({kCloud.points, {}}, CloudFormat::kBinary));
  EXPECT_EQ(plain.find("rgb"), std::string::npos);
  ASSERT_EQ(coordinates.size(), 24u);
  float value = 0;
  std::memcpy(&value, coordinates.data() + 16, 4);
  EXPECT_EQ(value, 3e8f);
  const auto [header, body] = SplitPcd(EncodePcd(kCloud, CloudFormat::kBinary));
  ASSERT_EQ(body.size(), 32u);
  EXPECT_EQ(body.substr(12, 4), std::string("\7\0\377\0", 4));  // blue green red, as in memory
}

}  // namespace
}  // namespace alidade
