#include "alidade/io/cloud.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "alidade/base/error.h"

namespace alidade::cloud_test {
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
  std::memcpy(&value, bytes.data() + body + 12, 4);  // the test machines are little endian
  EXPECT_EQ(value, 1e-7f);
  EXPECT_EQ(bytes.find("red"), std::string::npos);
  EXPECT_EQ(EncodePly(kCloud, CloudFormat::kBinary)
                .substr(EncodePly(kCloud, CloudFormat::kBinary).size() - 3),
            "\1\2\3");
}

// Splits a PCD file into header and body.
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

// Normal and sigma follow a point's color in both formats.
TEST(Ply, NormalsAndSigmasFollowTheColour) {
  Cloud cloud = kCloud;
  cloud.normals = {{0, 0, -1}, {0.6f, 0.8f, 0}};
  cloud.sigmas = {0.25f, 1e-3f};
  const std::string bytes = EncodePly(cloud, CloudFormat::kBinary);
  EXPECT_NE(bytes.find("property uchar blue\nproperty float nx\nproperty float ny\n"
                       "property float nz\nproperty float sigma\nend_header\n"),
            std::string::npos);
  const size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 2 * (12 + 3 + 12 + 4));
  float floats[4];
  std::memcpy(floats, bytes.data() + bytes.size() - 16, 16);
  EXPECT_EQ(floats[0], 0.6f);
  EXPECT_EQ(floats[1], 0.8f);
  EXPECT_EQ(floats[3], 1e-3f);
  const std::string text = EncodePly(cloud, CloudFormat::kAscii);
  EXPECT_NE(text.find("255 0 7 0 0 -1 0.25\n"), std::string::npos);
}

TEST(Pcd, NormalsAndSigmasHaveFieldsOfTheirOwn) {
  Cloud cloud = kCloud;
  cloud.normals = {{0, 0, -1}, {0.6f, 0.8f, 0}};
  cloud.sigmas = {0.25f, 1e-3f};
  const auto [header, body] = SplitPcd(EncodePcd(cloud, CloudFormat::kBinary));
  EXPECT_NE(header.find("FIELDS x y z rgb normal_x normal_y normal_z sigma\n"
                        "SIZE 4 4 4 4 4 4 4 4\nTYPE F F F U F F F F\nCOUNT 1 1 1 1 1 1 1 1\n"),
            std::string::npos);
  EXPECT_EQ(body.size(), 2u * 8 * 4);
}

TEST(Ply, IsReadAgainAsItWasWritten) {
  Cloud cloud = kCloud;
  for (int more = 0; more < 3; ++more) {
    if (more == 1) cloud.normals = {{0, 0, -1}, {0.6f, 0.8f, 0}};
    if (more == 2) cloud.sigmas = {0.25f, 1e-3f};
    for (const CloudFormat format : {CloudFormat::kAscii, CloudFormat::kBinary}) {
      const std::string bytes = EncodePly(cloud, format);
      const Cloud read = DecodePly(bytes, "a.ply");
      EXPECT_EQ(read.points, cloud.points);
      EXPECT_EQ(read.colors, cloud.colors);
      EXPECT_EQ(read.normals, cloud.normals);
      EXPECT_EQ(read.sigmas, cloud.sigmas);
      // Truncated anywhere it is rejected, except within the last number of a text.
      const size_t most = format == CloudFormat::kAscii ? bytes.rfind(' ') : bytes.size() - 1;
      for (size_t length = 0; length <= most; ++length)
        EXPECT_THROW(DecodePly(bytes.substr(0, length), "a.ply"), Error) << length;
    }
  }
  EXPECT_TRUE(DecodePly(EncodePly({}, CloudFormat::kAscii), "a.ply").points.empty());
}

TEST(Ply, OfOthersIsRefused) {
  for (const char* bytes :
       {"", "ply\n", "solid x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nend_header\n1\n",
        "ply\nformat ascii 1.0\nelement vertex 1e9\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n1 two 3\n"}) {
    EXPECT_THROW(DecodePly(bytes, "a.ply"), Error) << bytes;
  }
}

TEST(Ply, ListsOfDifferentLengthsAreRefused) {
  Cloud cloud = kCloud;
  cloud.sigmas = {0.25f};
  EXPECT_THROW(EncodePly(cloud, CloudFormat::kBinary), Error);
}

}  // namespace
}  // namespace alidade::cloud_test
