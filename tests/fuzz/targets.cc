#include "fuzz/targets.h"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "alidade/base/error.h"
#include "alidade/base/log.h"

namespace alidade::fuzz {

const std::vector<Target>& Targets() {
  static const std::vector<Target> targets = {
      {"map", Map},
      {"map_again", MapAgain},
      {"camera", CameraFile},
      {"euroc_camera", EurocCamera},
      {"kitti_calibration", KittiCalibration},
      {"config", Config},
      {"png", Png},
      {"jpeg", Jpeg},
      {"list", List},
      {"trajectory", Trajectory},
      {"onnx", Onnx},
      {"class_names", ClassNames},
      {"stream", Stream},
      {"bag", Bag},
      {"mcap", Mcap},
      {"database", Database},
      {"ros_message", RosMessage},
  };
  return targets;
}

bool Accepts(const Target& target, std::string_view bytes) {
  SetWarningListener([](const std::string&) {});
  const auto copy = std::make_unique<char[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), copy.get());
  try {
    target.run({copy.get(), bytes.size()});
  } catch (const Error& error) {
    const std::string said = error.what();
    Expect(said.size() >= 8, "an error that says nothing: '" + said + "'");
    return false;
  }
  return true;
}

void Expect(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

}  // namespace alidade::fuzz
