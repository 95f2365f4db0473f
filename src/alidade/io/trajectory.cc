#include "alidade/io/trajectory.h"

#include <array>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/io/stamp_unit.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

[[noreturn]] void Fail(const std::string& name, const TextLine& line, const std::string& what) {
  ThrowInput(name + ":" + std::to_string(line.number) + ": " + what);
}

std::vector<double> Numbers(const std::string& name, const TextLine& line, size_t wanted,
                            const char* layout) {
  const auto fields = Fields(line.text);
  if (fields.size() < wanted) {
    Fail(name, line,
         std::string("expected `") + layout + "`, found " + std::to_string(fields.size()) +
             " fields");
  }
  std::vector<double> numbers;
  for (size_t i = 0; i < wanted; ++i) {
    const auto number = ParseNumber(fields[i]);
    if (!number || !std::isfinite(*number)) {
      Fail(name, line, "`" + std::string(fields[i]) + "` is not a finite number");
    }
    numbers.push_back(*number);
  }
  return numbers;
}

Se3 PoseOf(const std::string& name, const TextLine& line, const Eigen::Vector3d& t,
           const Eigen::Quaterniond& q) {
  if (std::abs(q.norm() - 1) > 0.05) Fail(name, line, "the quaternion's length is not 1");
  return Se3::FromQuaternion(q, t);
}

// Converts stamps that cannot be seconds.
void StampsToSeconds(Trajectory& trajectory) {
  std::vector<double> times;
  for (const StampedPose& pose : trajectory) times.push_back(pose.time);
  if (CanBe(StampUnit::kSeconds, times)) return;
  const StampUnit unit = ProbableUnit(times, StampUnit::kSeconds);
  for (StampedPose& pose : trajectory) {
    pose.stamp = StampInSeconds(pose.stamp, unit);
    pose.time = ParseNumber(pose.stamp).value_or(pose.time);
  }
}

}  // namespace

Trajectory ParseTumTrajectory(std::string_view text, const std::string& name) {
  Trajectory trajectory;
  for (const TextLine& line : ContentLines(text)) {
    const auto v = Numbers(name, line, 8, "timestamp tx ty tz qx qy qz qw");
    trajectory.push_back({v[0], PoseOf(name, line, {v[1], v[2], v[3]}, {v[7], v[4], v[5], v[6]}),
                          std::string(Fields(line.text)[0])});
  }
  StampsToSeconds(trajectory);
  return trajectory;
}

Trajectory ParseEurocTrajectory(std::string_view text, const std::string& name,
                                const Se3& T_body_camera) {
  Trajectory trajectory;
  for (const TextLine& line : ContentLines(text)) {
    const auto v = Numbers(name, line, 8, "timestamp [ns], px, py, pz, qw, qx, qy, qz");
    const Se3 T_world_body = PoseOf(name, line, {v[1], v[2], v[3]}, {v[4], v[5], v[6], v[7]});
    const std::string stamp = StampInSeconds(Fields(line.text)[0], StampUnit::kNanoseconds);
    const auto time = ParseNumber(stamp);
    if (!time) Fail(name, line, "the time stamp is not a whole number of nanoseconds");
    trajectory.push_back({*time, T_world_body * T_body_camera, stamp});
  }
  return trajectory;
}

Trajectory ParseKittiTrajectory(std::string_view poses, const std::string& poses_name,
                                std::string_view times, const std::string& times_name) {
  const auto pose_lines = ContentLines(poses), time_lines = ContentLines(times);
  if (pose_lines.size() != time_lines.size()) {
    ThrowInput(poses_name + " has " + std::to_string(pose_lines.size()) + " poses, but " +
               times_name + " has " + std::to_string(time_lines.size()) + " times");
  }
  Trajectory trajectory;
  for (size_t i = 0; i < pose_lines.size(); ++i) {
    const double time = Numbers(times_name, time_lines[i], 1, "seconds")[0];
    const auto v = Numbers(poses_name, pose_lines[i], 12, "the 3 rows of [R t]");
    Eigen::Matrix3d R;
    R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
    if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 0.05 || R.determinant() < 0) {
      Fail(poses_name, pose_lines[i], "the left 3x3 part is not a rotation");
    }
    const Se3 pose = Se3{R, {v[3], v[7], v[11]}}.Normalised();
    trajectory.push_back({time, pose, std::string(Fields(time_lines[i].text)[0])});
  }
  return trajectory;
}

std::string FormatTime(double seconds) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::fixed << std::setprecision(9) << seconds;
  return out.str();
}

std::string FormatTumTrajectory(const Trajectory& trajectory) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::fixed << std::setprecision(9) << "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory) {
    if (pose.stamp.empty()) {
      out << pose.time;
    } else {
      out << pose.stamp;
    }
    const Eigen::Quaterniond q = pose.T_world_camera.Quaternion();
    for (double value : {pose.T_world_camera.t.x(), pose.T_world_camera.t.y(),
                         pose.T_world_camera.t.z(), q.x(), q.y(), q.z(), q.w()}) {
      out << ' ' << value;
    }
    out << '\n';
  }
  return out.str();
}

}  // namespace alidade
