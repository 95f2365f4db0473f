#include "alidade/ros/ros_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/ros/cdr.h"

namespace alidade {
namespace {

constexpr uint8_t kFloat32 = 7;  // constant FLOAT32 of sensor_msgs/PointField

void AddTime(const RosTime& time, CdrWriter& out) {
  out.Add(time.sec);
  out.Add(time.nanosec);
}

void AddHeader(const RosHeader& header, CdrWriter& out) {
  AddTime(header.stamp, out);
  out.AddText(header.frame_id);
}

// Transform and Pose have the same layout: translation, then quaternion x y z w.
void AddPlace(const Se3& place, CdrWriter& out) {
  const Eigen::Quaterniond q = place.Quaternion();
  for (const double value : {place.t.x(), place.t.y(), place.t.z(), q.x(), q.y(), q.z(), q.w()})
    out.Add(value);
}

// float64[36], row by row.
void AddCovariance(const Matrix6d& covariance, CdrWriter& out) {
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) out.Add(covariance(row, column));
  }
}

void AddVector(const Eigen::Vector3d& vector, CdrWriter& out) {
  for (const double value : {vector.x(), vector.y(), vector.z()}) out.Add(value);
}

template <typename Bits>
void AppendRaw(Bits value, std::string& data) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  data.append(raw, sizeof value);
}

}  // namespace

RosTime RosTime::FromSeconds(double seconds) {
  constexpr double kMost = std::numeric_limits<int32_t>::max();
  const double held = std::clamp(std::isfinite(seconds) ? seconds : 0, 0.0, kMost);
  double per_second = 1e6;
  int64_t nanoseconds = std::llround(held * 1e9);
  for (int64_t each = 1000; each >= 1; each /= 10, per_second *= 10) {
    const int64_t count = std::llround(held * per_second);
    if (static_cast<double>(count) / per_second != held) continue;
    nanoseconds = count * each;
    break;
  }
  return {static_cast<int32_t>(nanoseconds / 1000000000),
          static_cast<uint32_t>(nanoseconds % 1000000000)};
}

std::string EncodeTransforms(const std::vector<RosTransform>& transforms) {
  CdrWriter out;
  out.AddCount(transforms.size());
  for (const RosTransform& transform : transforms) {
    AddHeader({transform.stamp, transform.frame_id}, out);
    out.AddText(transform.child_frame_id);
    AddPlace(transform.T_frame_child, out);
  }
  return out.Take();
}

std::string EncodePose(const RosHeader& header, const Se3& pose) {
  CdrWriter out;
  AddHeader(header, out);
  AddPlace(pose, out);
  return out.Take();
}

std::string EncodeUncertainPose(const RosHeader& header, const RosUncertainPose& pose) {
  CdrWriter out;
  AddHeader(header, out);
  AddPlace(pose.T_frame_body, out);
  AddCovariance(pose.covariance, out);
  return out.Take();
}

std::string EncodeOdometry(const RosHeader& header, const RosOdometry& odometry) {
  CdrWriter out;
  AddHeader(header, out);
  out.AddText(odometry.child_frame_id);
  AddPlace(odometry.pose.T_frame_body, out);
  AddCovariance(odometry.pose.covariance, out);
  AddVector(odometry.velocity, out);
  AddVector(odometry.rate, out);
  AddCovariance(odometry.twist_covariance, out);
  return out.Take();
}

std::string EncodePath(const RosHeader& header, const std::vector<RosPose>& poses) {
  CdrWriter out;
  AddHeader(header, out);
  out.AddCount(poses.size());
  for (const RosPose& pose : poses) {
    AddHeader({pose.stamp, header.frame_id}, out);
    AddPlace(pose.T_frame_body, out);
  }
  return out.Take();
}

std::string EncodeGrid(const RosHeader& header, const RosGrid& grid) {
  CdrWriter out;
  AddHeader(header, out);
  AddTime(header.stamp, out);
  out.Add(static_cast<float>(grid.cell));
  out.Add(grid.width);
  out.Add(grid.height);
  AddPlace(grid.T_frame_corner, out);
  out.AddBytes({reinterpret_cast<const char*>(grid.cells.data()), grid.cells.size()});
  return out.Take();
}

std::string EncodeCloud(const RosHeader& header, const Cloud& cloud) {
  const bool colored = !cloud.colors.empty();
  std::vector<const char*> fields = {"x", "y", "z"};
  if (colored) fields.push_back("rgb");
  const auto step = static_cast<uint32_t>(sizeof(float) * fields.size());
  const auto count = static_cast<uint32_t>(cloud.points.size());
  std::string data;
  data.reserve(static_cast<size_t>(step) * count);
  for (size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) AppendRaw(cloud.points[i][axis], data);
    if (!colored) continue;
    const auto [red, green, blue] = cloud.colors[i];
    AppendRaw(static_cast<uint32_t>(red << 16 | green << 8 | blue), data);
  }
  CdrWriter out;
  AddHeader(header, out);
  out.Add(uint32_t{1});
  out.Add(count);
  out.AddCount(fields.size());
  for (size_t i = 0; i < fields.size(); ++i) {
    out.AddText(fields[i]);
    out.Add(static_cast<uint32_t>(sizeof(float) * i));
    out.Add(kFloat32);
    out.Add(uint32_t{1});
  }
  out.Add(false);
  out.Add(step);
  out.Add(step * count);
  out.AddBytes(data);
  out.Add(true);
  return out.Take();
}

std::string EncodeImage(const RosHeader& header, std::string_view format, std::string_view bytes) {
  CdrWriter out;
  AddHeader(header, out);
  out.AddText(format);
  out.AddBytes(bytes);
  return out.Take();
}

std::string EncodeCameraInfo(const RosHeader& header, const Camera& camera) {
  CdrWriter out;
  AddHeader(header, out);
  out.Add(static_cast<uint32_t>(camera.height));
  out.Add(static_cast<uint32_t>(camera.width));
  out.AddText("plumb_bob");
  out.AddCount(camera.distortion.size());
  for (const double k : camera.distortion) out.Add(k);
  const double k[] = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  for (const double value : k) out.Add(value);
  for (const double value : {1., 0., 0., 0., 1., 0., 0., 0., 1.}) out.Add(value);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.Add(k[3 * row + column]);
    out.Add(0.0);
  }
  // Binning and region of interest: the full image.
  for (int i = 0; i < 6; ++i) out.Add(uint32_t{0});
  out.Add(false);
  return out.Take();
}

std::string EncodeDiagnostics(const RosTime& stamp, const std::vector<RosStatus>& all) {
  CdrWriter out;
  AddHeader({stamp, ""}, out);
  out.AddCount(all.size());
  for (const RosStatus& status : all) {
    out.Add(static_cast<uint8_t>(status.level));
    out.AddText(status.name);
    out.AddText(status.message);
    out.AddText(status.hardware_id);
    out.AddCount(status.values.size());
    for (const auto& [key, value] : status.values) {
      out.AddText(key);
      out.AddText(value);
    }
  }
  return out.Take();
}

std::string EncodeLog(const RosTime& stamp, RosLogLevel level, std::string_view name,
                      std::string_view text) {
  CdrWriter out;
  AddTime(stamp, out);
  out.Add(static_cast<uint8_t>(level));
  out.AddText(name);
  out.AddText(text);
  out.AddText("");  // file
  out.AddText("");  // function
  out.Add(uint32_t{0});
  return out.Take();
}

}  // namespace alidade
