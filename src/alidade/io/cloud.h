// Point clouds as PLY (Turk 1994).
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

enum class PlyFormat { kAscii, kBinary };  // binary is little endian, on any machine

// The file's bytes.
std::string EncodePly(const Cloud& cloud, PlyFormat format);

}  // namespace alidade
