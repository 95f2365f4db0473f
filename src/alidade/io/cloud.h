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

// An empty list means unknown; otherwise it has one entry per point.
struct Cloud {
  std::vector<Eigen::Vector3f> points;              // meters
  std::vector<std::array<uint8_t, 3>> colors = {};  // red green blue
  std::vector<Eigen::Vector3f> normals = {};        // unit length; 0: unknown for this point
  std::vector<float> sigmas = {};  // meters, standard deviation along the viewing ray
};

enum class CloudFormat { kAscii, kBinary };  // binary files are little endian on every machine

// Return the file's bytes. Throw Error (usage) when the lists differ in length.
std::string EncodePly(const Cloud& cloud, CloudFormat format);
std::string EncodePcd(const Cloud& cloud, CloudFormat format);  // colors in the field `rgb`

// Decodes what EncodePly() wrote. Throws Error (input), naming `name`, for any other bytes.
Cloud DecodePly(std::string_view bytes, const std::string& name);

}  // namespace alidade
