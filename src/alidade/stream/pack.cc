#include "alidade/stream/pack.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace alidade {
namespace {

template <typename T>
void Append(const T& value, std::vector<uint8_t>& bytes) {
  const auto* from = reinterpret_cast<const uint8_t*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}
template <typename T>
T Read(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

}  // namespace

stream::Pose PackPose(const Se3& pose) {
  const Eigen::Quaterniond q = pose.Quaternion();
  return {q.x(), q.y(), q.z(), q.w(), pose.t.x(), pose.t.y(), pose.t.z()};
}

Se3 UnpackPose(const stream::Pose& pose) {
  return Se3::FromQuaternion({pose.qw(), pose.qx(), pose.qy(), pose.qz()},
                             {pose.tx(), pose.ty(), pose.tz()});
}

uint16_t PackPlace(double pixel, int size) {
  const double value = std::round((pixel + 0.5) * 65536 / size);
  return static_cast<uint16_t>(std::clamp(value, 0.0, 65535.0));
}

double UnpackPlace(uint16_t value, int size) { return value * size / 65536.0 - 0.5; }

void PackFeature(const FeatureUse& feature, const Camera& camera, std::vector<uint8_t>& bytes) {
  Append(PackPlace(feature.x, camera.width), bytes);
  Append(PackPlace(feature.y, camera.height), bytes);
  const stream::Use use = feature.static_probability < 0.5f ? stream::Use::moving
                          : feature.fresh                   ? stream::Use::fresh
                          : feature.matched                 ? stream::Use::matched
                                                            : stream::Use::free;
  bytes.push_back(static_cast<uint8_t>(use));
  bytes.push_back(
      static_cast<uint8_t>(std::lround(255 * std::clamp(feature.static_probability, 0.f, 1.f))));
}

void PackLandmark(LandmarkId id, const ToldLandmark& told, std::vector<uint8_t>& bytes) {
  Append(id.value, bytes);
  Append(told.keyframe.value, bytes);
  Append(told.p.x(), bytes);
  Append(told.p.y(), bytes);
  Append(told.p.z(), bytes);
}

std::pair<LandmarkId, ToldLandmark> UnpackLandmark(const uint8_t* bytes) {
  ToldLandmark told;
  told.keyframe.value = Read<uint32_t>(bytes + 4);
  told.p = {Read<float>(bytes + 8), Read<float>(bytes + 12), Read<float>(bytes + 16)};
  return {{Read<uint32_t>(bytes)}, told};
}

PackedCloud PackCloud(const DepthMap& depth, int most_points) {
  PackedCloud cloud;
  const auto count = static_cast<int>(depth.pixels.size());
  if (count == 0 || most_points <= 0) return cloud;
  const int every = (count + most_points - 1) / most_points;
  const auto normalised = [&](const DepthPixel& pixel) {
    return static_cast<float>(pixel.inverse_depth * depth.scale);
  };
  cloud.least = cloud.most = normalised(depth.pixels.front());
  for (const DepthPixel& pixel : depth.pixels) {
    cloud.least = std::min(cloud.least, normalised(pixel));
    cloud.most = std::max(cloud.most, normalised(pixel));
  }
  const double span = std::log(static_cast<double>(cloud.most) / cloud.least);
  std::vector<uint8_t> bytes;
  for (int i = 0; i < count; i += every) {
    const DepthPixel& pixel = depth.pixels[static_cast<size_t>(i)];
    const double share = span > 0 ? std::log(normalised(pixel) / cloud.least) / span : 0;
    Append(PackPlace(pixel.x, depth.width), bytes);
    Append(PackPlace(pixel.y, depth.height), bytes);
    Append(static_cast<uint16_t>(std::lround(65535 * std::clamp(share, 0.0, 1.0))), bytes);
    const auto [red, green, blue] = pixel.rgb;
    Append(static_cast<uint16_t>(red >> 3 << 11 | green >> 2 << 5 | blue >> 3), bytes);
  }
  cloud.bytes.assign(bytes.begin(), bytes.end());
  return cloud;
}

CloudPoint UnpackPoint(const uint8_t* bytes, float least, float most, int width, int height) {
  CloudPoint point;
  point.x = UnpackPlace(Read<uint16_t>(bytes), width);
  point.y = UnpackPlace(Read<uint16_t>(bytes + 2), height);
  point.inverse_depth =
      least * std::pow(static_cast<double>(most) / least, Read<uint16_t>(bytes + 4) / 65535.0);
  const auto color = Read<uint16_t>(bytes + 6);
  point.red = static_cast<uint8_t>((color >> 11) * 255 / 31);
  point.green = static_cast<uint8_t>((color >> 5 & 63) * 255 / 63);
  point.blue = static_cast<uint8_t>((color & 31) * 255 / 31);
  return point;
}

}  // namespace alidade
