#include "alidade/io/cloud.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

namespace alidade {
namespace {

const Cloud kCloud{{{1.5f, -2, 0.1f}, {1e-7f, 3e8f, -0.f}}, {{255, 0, 7}, {1, 2, 3}}};

TEST(Ply, AsciiReadsBackToTheSameFloats) {
  std::istringstream in(EncodePly(kCloud, PlyFormat::kAscii));
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
  const std::string bytes = EncodePly({kCloud.points, {}}, PlyFormat::kBinary);
  const size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 24);
  float value = 0;
  std::memcpy(&value, bytes.data() + body + 12, 4);  // the machines we test on are little endian
  EXPECT_EQ(value, 1e-7f);
  EXPECT_EQ(bytes.find("red"), std::string::npos);
  EXPECT_EQ(EncodePly(kCloud, PlyFormat::kBinary)
                .substr(EncodePly(kCloud, PlyFormat::kBinary).size() - 3),
            "\1\2\3");
}

}  // namespace
}  // namespace alidade
