#include "alidade/io/trajectory.h"

#include <cmath>
#include <functional>

#include "alidade/base/error.h"
#include "alidade/io/text.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {
namespace {

void Use(const alidade::Trajectory& trajectory) {
  for (const StampedPose& pose : trajectory) {
    Expect(std::isfinite(pose.time), "a pose's time is not finite");
    const Se3& T = pose.T_world_camera;
    Expect(T.R.allFinite() && T.t.allFinite(), "a pose is not finite");
    Expect(std::abs(T.R.determinant() - 1) < 1e-6, "a pose's rotation is none");
  }
  const auto again = ParseTumTrajectory(FormatTumTrajectory(trajectory), "again");
  Expect(again.size() == trajectory.size(), "a trajectory cannot be read as it was written");
}

}  // namespace

void Trajectory(std::string_view bytes) {
  CheckIsText(bytes, "groundtruth.txt");
  const std::function<alidade::Trajectory()> formats[] = {
      [&] { return ParseTumTrajectory(bytes, "groundtruth.txt"); },
      [&] { return ParseEurocTrajectory(bytes, "data.csv", {}); },
      // The first number of a pose serves as a time.
      [&] { return ParseKittiTrajectory(bytes, "poses.txt", bytes, "times.txt"); }};
  bool any = false;
  std::string problem;
  for (const auto& parse : formats) {
    alidade::Trajectory trajectory;
    try {
      trajectory = parse();
    } catch (const Error& error) {
      problem = error.what();
      continue;
    }
    any = true;
    try {
      Use(trajectory);
    } catch (const Error& error) {
      Expect(false, std::string("what was read is refused later: ") + error.what());
    }
  }
  if (!any) ThrowInput(problem);
}

}  // namespace alidade::fuzz
