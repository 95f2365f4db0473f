// `alidade calibrate`: the camera of recordings that nobody calibrated.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/run/any_source.h"
#include "alidade/run/find_camera.h"
#include "alidade/run/loop.h"
#include "alidade/run/options.h"
#include "commands.h"
#include "terminal.h"

namespace alidade {
namespace {

struct CalibrateOptions {
  std::vector<std::string> sources;
  RunOptions run;
};

int CalibrateCommand(const CalibrateOptions& options) {
  CatchInterrupts();
  RunSettings settings = SettingsFrom(options.run);
  settings.slam.start.two_view.lens_uncertainty = 0.6;
  Terminal terminal(options.run.quiet);
  for (const std::string& source : options.sources) {
    SourceOptions wanted = SourceOptionsFrom(options.run);
    wanted.sensor = Sensor::kMono;
    const auto open = [&] { return OpenAnySource(source, wanted); };
    int asked = 0;
    const bool trace = std::getenv("TRACE") != nullptr;
    const CameraFound found =
        FindCamera(open, settings.slam, settings.calibrate, [&](const CalibrateProgress& now) {
          if (trace && now.keyframes != asked && now.keyframes > 0)
            std::printf("  pass %d frame %d kf %d: %s noise %.2f obs %d\n", now.pass, now.frames,
                        now.keyframes, CameraInWords(now.estimate).c_str(), now.estimate.noise,
                        now.estimate.observations);
          asked = now.keyframes;
          return !Interrupted();
        });
    std::printf("%s: %s %s; %d passes %d frames %d kf %d obs noise %.2f\n", source.c_str(),
                CameraInWords(found.estimate).c_str(),
                found.estimate.known ? "known"
                : found.usable       ? "usable"
                                     : "unknown",
                found.passes, found.frames, found.estimate.keyframes, found.estimate.observations,
                found.estimate.noise);
  }
  return 0;
}

}  // namespace

void AddCalibrateCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("calibrate", "Find a camera's focal length and distortion");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("RECORDING", options->sources, "Recordings of one camera")->required();
  command->add_option("--fov", options->run.fov, "Horizontal field of view to begin with, degrees");
  command->add_option("--profile", options->run.profile, "desktop or phone");
  command->add_option("--first", options->run.first, "First frame, counted from 0");
  command->add_option("--last", options->run.last, "Last frame, included");
  command->add_option("--set", options->run.settings, "One setting, name=value")
      ->take_all()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->callback(
      [options, &action] { action = [options] { return CalibrateCommand(*options); }; });
}

}  // namespace alidade
