// `alidade georeference`: aligns a finished result with inertial readings or measured positions.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "alidade/run/georeference/georeference.h"
#include "commands.h"

namespace alidade {
namespace {

struct GeoreferenceOptions {
  std::string result, out;
  std::vector<double> antenna;
  bool quiet = false;
  GeoreferenceSettings how;
};

int GeoreferenceCommand(const GeoreferenceOptions& options) {
  GeoreferenceSettings how = options.how;
  if (!options.antenna.empty())
    how.antenna = {options.antenna[0], options.antenna[1], options.antenna[2]};
  std::string result = options.result;
  while (result.size() > 1 && result.back() == '/') result.pop_back();
  const std::string out = options.out.empty() ? result + "-georeferenced" : options.out;
  const std::vector<std::string> lines = Georeference(result, out, how);
  if (options.quiet) return 0;
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  std::printf("%s: the result in meters, z up\n", out.c_str());
  return 0;
}

}  // namespace

void AddGeoreferenceCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "georeference", "Give a finished result meters, the vertical, and its place");
  const auto options = std::make_shared<GeoreferenceOptions>();
  command->add_option("RESULT", options->result, "Result folder of `alidade run`")
      ->required()
      ->type_name("PATH");
  command
      ->add_option(
          "--to", options->how.to,
          "Table of inertial readings (time, angular rate x y z, acceleration x y z), or of "
          "positions: time and x, y, z in meters (z up) or lat, lon, alt, by the names in "
          "the first line")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--out", options->out,
                   "Folder of the new result; default: RESULT-georeferenced. The one of an earlier "
                   "call is replaced")
      ->type_name("PATH");
  command->add_option("--kind", options->how.kind, "What the table has; auto: by its columns")
      ->type_name("auto|imu|positions")
      ->capture_default_str();
  command
      ->add_option(
          "--time-offset", options->how.time_offset,
          "An image of time t was taken at t + SECONDS on the clock of the table; default: "
          "estimated")
      ->type_name("SECONDS");
  command
      ->add_option(
          "--camera", options->how.camera,
          "Inertial readings: camera.yaml whose block imu says what is known of the sensor; "
          "default: its rotation, place and clock are estimated")
      ->type_name("FILE");
  command
      ->add_option("--antenna", options->antenna,
                   "Positions: place of the receiver seen from the camera, in meters to the right, "
                   "down and forward")
      ->expected(3)
      ->type_name("X Y Z");
  command->add_flag("--quiet", options->quiet, "Print errors only");
  command->footer(
      "\nExamples:\n  alidade georeference alidade-out/walk --to walk.imu.csv        meters and "
      "the vertical\n  alidade georeference alidade-out/ride --to gnss.csv            meters, "
      "east, north, up\n  alidade georeference alidade-out/hall --to survey.csv --time-offset 0 "
      "--out hall-m\n\nAll files of the new folder are in meters with z up: trajectory, map, "
      "clouds, depth. With lat, lon, alt x is east,\ny north, and the origin is the first "
      "position (stats.json: georeference.origin).\nPositions that disagree are left out. If scale "
      "or rotation are not observable, nothing is written, and the reason is\ntold with figures: "
      "inertial readings need a motion that is not even; positions need a path that is not "
      "straight,\nor a map that knows gravity (docs/guides/georeference.md).");
  command->callback(
      [options, &action] { action = [options] { return GeoreferenceCommand(*options); }; });
}

}  // namespace alidade
