// Point clouds as PLY (Turk 1994) and PCD (Point Cloud Library, v0.7).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// What is empty is not known; else there is one for each point.
struct Cloud {
  std::vector<Eigen::Vector3f> points;              // metres
  std::vector<std::array<uint8_t, 3>> colors = {};  // red green blue
  std::vector<Eigen::Vector3f> normals = {};        // unit length, or 0: not known for this point
  std::vector<float> sigmas = {};                   // metres, along the ray it was seen by
};

enum class CloudFormat { kAscii, kBinary };  // binary is little endian, on any machine

// The file's bytes. Throw Error (usage) on a cloud whose lists differ in length.
std::string EncodePly(const Cloud& cloud, CloudFormat format);
std::string EncodePcd(const Cloud& cloud, CloudFormat format);  // colours as the field `rgb`

// What EncodePly() wrote. Throws Error (input), naming `name`, on any other bytes.
Cloud DecodePly(std::string_view bytes, const std::string& name);

}  // namespace alidade
