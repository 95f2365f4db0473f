// Point clouds as PLY (Turk 1994) and PCD (Point Cloud Library, v0.7).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace alidade {

struct Cloud {
  std::vector<Eigen::Vector3f> points;  // metres
  std::vector<std::array<uint8_t, 3>> colors =
      {};  // red green blue; empty: none, else one for each point
};

enum class CloudFormat { kAscii, kBinary };  // binary is little endian, on any machine

// The file's bytes.
std::string EncodePly(const Cloud& cloud, CloudFormat format);
std::string EncodePcd(const Cloud& cloud, CloudFormat format);  // colours as the field `rgb`

}  // namespace alidade
