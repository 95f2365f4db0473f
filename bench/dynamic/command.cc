#include <memory>

#include "bench/benches.h"
#include "bench/dynamic/dynamic.h"
#include "bench/measure/print.h"
#include "bench/measure/result_file.h"
#include "bench/options.h"

namespace alidade::bench {
namespace {

struct DynamicArguments {
  DynamicOptions options;
  std::string out;
};

}  // namespace

void AddDynamicBench(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("dynamic", "SLAM among moving people, and what leaving them out is worth");
  const auto arguments = std::make_shared<DynamicArguments>();
  DynamicOptions& options = arguments->options;
  AddRecordings(*command, options.sources,
                "Recordings with a truth, or folders of them (synth:room?actors=3, with depth and "
                "stereo)");
  AddFrames(*command, options.frames, "Frames of each, at most (200; recorded ones: all)");
  AddSeeds(*command, options.seeds, "Runs of each kind");
  AddSettings(*command, options.settings);
  command
      ->add_option("--detector", options.detector,
                   "Network that finds people (.onnx), for mode full")
      ->type_name("FILE");
  command
      ->add_option("--camera", options.camera,
                   "Calibration (camera.yaml) instead of the recordings' own")
      ->type_name("FILE");
  AddMany(*command, "--sensor", options.sensors,
          "rgbd, stereo, mono; default: the recording's own, and mono");
  AddMany(*command, "--plain", options.plain,
          "The same frames without people, DIR or DIR:first-last, for each recording");
  command->add_flag("--ablation", options.ablation, "What each part is worth");
  command->add_flag("--latency", options.latency, "Late and lost detections");
  command->add_flag("!--no-live", options.live, "Leave out the threaded runs, which take time");
  command
      ->add_option("--pictures", options.pictures,
                   "Folder for pictures of the features, before and after")
      ->type_name("FOLDER");
  AddOut(*command, arguments->out);
  command->callback([arguments, &action] {
    action = [arguments] {
      const Section section = BenchDynamic(arguments->options);
      PrintSection(section);
      WriteResult(arguments->out, "dynamic", {section});
      return 0;
    };
  });
}

}  // namespace alidade::bench
