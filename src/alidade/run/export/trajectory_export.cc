#include "alidade/run/export/trajectory_export.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/export/map_models.h"
#include "alidade/run/export/own_recording.h"
#include "alidade/run/export/posed_frames.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/run/world/trajectory_file_for.h"

namespace alidade {
namespace {

constexpr double kLeastUpright = 0.5;  // of the mean axis: the camera was within 60° of upright

std::ostringstream PoseText() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(12);
  return out;
}

// Whole nanoseconds: of the stamp as written if it is a decimal number of seconds.
std::string Nanoseconds(const StampedPose& pose) {
  const std::string stamp = pose.stamp.empty() ? FormatTime(pose.time) : pose.stamp;
  const size_t dot = stamp.find('.');
  std::string whole = stamp.substr(0, dot),
              rest = dot == std::string::npos ? "" : stamp.substr(dot + 1);
  rest.resize(9, '0');
  if ((whole + rest).find_first_not_of("0123456789") != std::string::npos)
    return std::to_string(std::llround(pose.time * 1e9));
  whole.erase(0, std::min(whole.find_first_not_of('0'), whole.size()));
  std::string digits = whole + rest;
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));
  return digits;
}

}  // namespace

std::string FormatKittiTrajectory(const Trajectory& trajectory) {
  std::ostringstream out = PoseText();
  for (const StampedPose& pose : trajectory) {
    const Se3& T = pose.T_world_camera;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) out << T.R(r, c) << ' ';
      out << T.t(r) << (r < 2 ? ' ' : '\n');
    }
  }
  return out.str();
}

std::string FormatEurocTrajectory(const Trajectory& trajectory) {
  std::ostringstream out = PoseText();
  out << "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
         "q_RS_y [], q_RS_z []\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.T_world_camera.t;
    const Eigen::Quaterniond q = pose.T_world_camera.Quaternion();
    out << Nanoseconds(pose);
    for (double value : {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) out << ',' << value;
    out << '\n';
  }
  return out.str();
}

Trajectory WithZUp(Trajectory trajectory) {
  if (trajectory.empty()) return trajectory;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : trajectory) up -= pose.T_world_camera.R.col(1);
  up /= static_cast<double>(trajectory.size());
  if (!(up.norm() >= kLeastUpright)) {
    ThrowInput(
        "--up z: the camera was held upright too rarely to tell the vertical from its own axes");
  }
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ());
  const Se3 T_up_world = Se3::FromQuaternion(turn, Eigen::Vector3d::Zero());
  for (StampedPose& pose : trajectory) pose.T_world_camera = T_up_world * pose.T_world_camera;
  return trajectory;
}

std::string FormatTrajectory(Trajectory trajectory, const ExportSettings& settings) {
  if (settings.up == "z") trajectory = WithZUp(std::move(trajectory));
  if (settings.to == "kitti") return FormatKittiTrajectory(trajectory);
  if (settings.to == "euroc") return FormatEurocTrajectory(trajectory);
  return FormatTumTrajectory(trajectory);
}

std::string ExportTrajectory(const std::string& path, const SavedMap& saved,
                             const ExportSettings& settings, const Sim3& T_now_written,
                             const std::string& out) {
  const MapPart part = PartFor(saved, settings);
  const std::string file = TrajectoryFileFor(saved, part, ResultFolderOf(path));
  const bool frames = settings.poses == "frames" ||
                      (settings.poses == "default" && settings.to != "tum" && !file.empty());
  if (frames && file.empty())
    ThrowUsage("--poses frames needs the result folder of the run, with its trajectory");
  Trajectory trajectory = frames ? ReadTrajectory(file) : TrajectoryOf(saved, part);
  if (frames) trajectory = InNewWorld(std::move(trajectory), T_now_written);
  WriteExportFile(out, FormatTrajectory(trajectory, settings));
  return std::to_string(trajectory.size()) + " poses" + (frames ? "" : " of keyframes");
}

}  // namespace alidade
