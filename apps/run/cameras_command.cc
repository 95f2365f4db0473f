// `alidade cameras`: lists the cameras of this machine and what they can do.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "alidade/base/print.h"
#include "alidade/io/camera/v4l2_camera.h"
#include "commands.h"

namespace alidade {
namespace {

constexpr char kCamerasExamples[] =
    "\nExamples:\n"
    "  alidade cameras\n"
    "  alidade run camera:0 --viewer\n"
    "  alidade run \"camera:0?size=1280x720&fps=60&format=MJPEG&exposure=8ms\" --viewer\n"
    "  alidade run \"camera:0?size=1280x480&stereo=side-by-side\" --camera pair.yaml\n"
    "\nA * marks what camera:N takes if nothing is asked for. Streams of the network need no "
    "list:\n"
    "alidade run rtsp://192.168.1.20:8554/cam. More: docs/guides/live-cameras.md.";

std::string Rate(double fps) {
  char text[40];
  PrintTo(text, sizeof text, "%.4g", fps);
  return text;
}

// One line for each format and size, with all its rates.
void PrintModes(const CameraDevice& camera) {
  const CameraMode* chosen = ChooseMode(camera.modes, {});
  for (size_t i = 0; i < camera.modes.size();) {
    const CameraMode& mode = camera.modes[i];
    std::string rates;
    bool marked = false;
    for (; i < camera.modes.size() && camera.modes[i].format == mode.format &&
           camera.modes[i].size == mode.size;
         ++i) {
      const bool usual = &camera.modes[i] == chosen;
      marked = marked || usual;
      if (camera.modes[i].fps > 0)
        rates += (rates.empty() ? "" : ", ") + Rate(camera.modes[i].fps) + (usual ? "*" : "");
    }
    std::printf("  %c %-5s %5d x %-5d%s%s\n", marked ? '*' : ' ', mode.format->name,
                mode.size.width, mode.size.height, rates.empty() ? "" : " fps=", rates.c_str());
  }
  for (const std::string& other : camera.others)
    std::printf("    %-5s (not read by Alidade)\n", other.c_str());
  for (const std::string& control : camera.controls) std::printf("    %s\n", control.c_str());
}

nlohmann::json AsJson(const std::vector<CameraDevice>& cameras) {
  nlohmann::json all = nlohmann::json::array();
  for (const CameraDevice& camera : cameras) {
    nlohmann::json modes = nlohmann::json::array();
    const CameraMode* chosen = ChooseMode(camera.modes, {});
    for (const CameraMode& mode : camera.modes) {
      modes.push_back({{"format", mode.format->name},
                       {"width", mode.size.width},
                       {"height", mode.size.height},
                       {"fps", mode.fps},
                       {"chosen", &mode == chosen}});
    }
    all.push_back({{"device", camera.path},
                   {"name", camera.name},
                   {"bus", camera.bus},
                   {"modes", modes},
                   {"other_formats", camera.others},
                   {"controls", camera.controls}});
  }
  return all;
}

int ListCameras(bool as_json) {
  std::vector<std::string> problems;
  const std::vector<CameraDevice> cameras = FindCameras(&problems);
  for (const std::string& problem : problems)
    std::fprintf(stderr, "alidade: %s\n", problem.c_str());
  if (as_json) {
    std::printf("%s\n", AsJson(cameras).dump(2).c_str());
    return 0;
  }
  if (cameras.empty()) std::printf("no camera is connected\n");
  for (const CameraDevice& camera : cameras) {
    const std::string number = camera.path.substr(camera.path.find_first_of("0123456789"));
    std::printf("camera:%s  %s (%s)\n", number.c_str(), camera.name.c_str(), camera.path.c_str());
    PrintModes(camera);
  }
  return 0;
}

}  // namespace

void AddCamerasCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("cameras", "List the cameras of this machine and what they can do");
  const auto as_json = std::make_shared<bool>(false);
  command->add_flag("--json", *as_json, "As JSON");
  command->footer(kCamerasExamples);
  command->callback([as_json, &action] { action = [as_json] { return ListCameras(*as_json); }; });
}

}  // namespace alidade
