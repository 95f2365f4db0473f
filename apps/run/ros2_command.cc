// alidade ros2: runs on topics of ROS 2 and publishes poses and map on others.
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/ros/live/live_source.h"
#include "alidade/run/ros2/ros2_publisher.h"
#include "commands.h"
#include "run/mount_text.h"
#include "run/run_and_tell.h"
#include "run/run_flags.h"

namespace alidade {
namespace {

constexpr char kRos2Examples[] =
    "\nExamples:\n"
    "  alidade ros2                                       finds images, depth and calibration\n"
    "  alidade ros2 --image /cam0/image_raw --imu-topic /imu\n"
    "  ROS_DOMAIN_ID=7 alidade ros2 --base-frame base_footprint\n"
    "  alidade ros2 --mount \"0.2 0 0.5 0 0.3 0\"           20 cm ahead, 50 cm up, 17 degrees "
    "down\n"
    "  alidade ros2 --load place/map.alidade --localize   poses in a map that was made before\n"
    "  alidade ros2 camera:0 --fov 70                     publishes the poses of a USB camera\n"
    "\nPublishes /tf (map -> odom -> base_link), /tf_static, /alidade/odometry, /alidade/pose, "
    "/alidade/path,\n/alidade/landmarks, /alidade/semidense, /alidade/events and /diagnostics "
    "(with --grid /map), and "
    "writes the files of\n`alidade run` at the end (Ctrl-C). ROS need not be installed. Lists of "
    "topics, frames and launch\nlines: docs/guides/ros2.md.";

struct Ros2Flags {
  RunOptions run;
  Ros2Options node;
  std::optional<std::string> image, depth, right, info, right_info, imu, mount;
};

// The source with the topics that were named.
std::string SourceWithTopics(const Ros2Flags& flags) {
  std::string source = flags.run.source;
  const std::pair<const char*, const std::optional<std::string>*> topics[] = {
      {"image", &flags.image}, {"depth", &flags.depth},           {"right", &flags.right},
      {"info", &flags.info},   {"right_info", &flags.right_info}, {"imu", &flags.imu}};
  for (const auto& [name, topic] : topics) {
    if (!*topic) continue;
    if (!IsRos2Source(source))
      ThrowUsage(std::string("topics can be named for the source ros2: only, not for ") + source);
    source +=
        (source.find('?') == std::string::npos ? "?" : "&") + std::string(name) + "=" + **topic;
  }
  return source;
}

int RunAndPublish(const Ros2Flags& flags) {
  RunOptions options = flags.run;
  if (options.localize && !options.load) ThrowUsage("--localize needs a map: --load FILE");
  options.source = SourceWithTopics(flags);
  options.base_frame = flags.node.names.base;
  if (!options.schedule) options.schedule = "threaded";
  Ros2Options node = flags.node;
  if (flags.mount) node.mount = MountOf(*flags.mount);
  return RunAndTell(options, [&](StreamHub& hub, const StreamFeedSettings& settings) {
    return std::make_unique<Ros2Publisher>(node, hub, settings);
  });
}

}  // namespace

void AddRos2Command(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "ros2", "Take part in ROS 2: run on live topics, publish transforms, odometry and map");
  auto flags = std::make_shared<Ros2Flags>();
  AddPublishedRunOptions(*command, flags->run);
  command->add_flag("--localize", flags->run.localize,
                    "Only find poses in the map of --load, which is not changed");
  const auto topic = [&](const char* name, std::optional<std::string>& value, const char* what) {
    command->add_option(name, value, what)->type_name("TOPIC");
  };
  topic("--image", flags->image, "Images; default: found by type, as in a recording");
  topic("--depth", flags->depth, "Depth that is registered to the images");
  topic("--right", flags->right, "Images of the right camera");
  topic("--info", flags->info, "Calibration of the images");
  topic("--right-info", flags->right_info, "Calibration of the right camera");
  topic("--imu-topic", flags->imu, "Inertial readings");
  command->add_option("--map-frame", flags->node.names.map, "Default: map")->type_name("NAME");
  command->add_option("--odom-frame", flags->node.names.odom, "Default: odom")->type_name("NAME");
  command->add_option("--base-frame", flags->node.names.base, "Of the robot. Default: base_link")
      ->type_name("NAME");
  command
      ->add_option("--camera-frame", flags->node.names.camera,
                   "Optical frame of the camera. Default: that of the images' messages")
      ->type_name("NAME");
  command
      ->add_option("--mount", flags->mount,
                   std::string(kMountHelp) + "by /tf_static, else at the base, looking ahead")
      ->type_name("NUMBERS");
  command->add_flag("--grid", flags->node.grid,
                    "Publish a floor grid for planners on /map, by depth or a stereo pair");
  command->footer(kRos2Examples);
  command->callback([flags, &action] { action = [flags] { return RunAndPublish(*flags); }; });
}

}  // namespace alidade
