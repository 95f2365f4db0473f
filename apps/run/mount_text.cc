#include "run/mount_text.h"

#include <Eigen/Geometry>
#include <cmath>
#include <sstream>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/ros/robot_frames.h"

namespace alidade {

Se3 MountOf(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  bool finite = words.eof();
  for (const double number : numbers) finite = finite && std::isfinite(number);
  if (!finite || (numbers.size() != 6 && numbers.size() != 7))
    ThrowUsage(
        "--mount takes \"x y z roll pitch yaw\" (meters, radians) or \"x y z qx qy qz qw\" "
        "of the optical frame, not '" +
        text + "'");
  const Eigen::Vector3d t(numbers[0], numbers[1], numbers[2]);
  if (numbers.size() == 7) {
    const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
    if (q.norm() < 1e-6) ThrowUsage("--mount: the quaternion is 0");
    return Se3::FromQuaternion(q, t);
  }
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(numbers[5], Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(numbers[4], Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(numbers[3], Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  return Se3{R, t} * CameraAtBase();
}

}  // namespace alidade
