#include <memory>

#include "bench/benches.h"
#include "bench/measure/print.h"
#include "bench/measure/result_file.h"
#include "bench/options.h"
#include "bench/scale/large_map.h"
#include "bench/scale/lasting.h"

namespace alidade::bench {
namespace {

struct LastingArguments {
  std::vector<std::string> recordings;
  std::string out, sensor;
  int frames = 20000;
};

int RunLasting(LastingArguments arguments) {
  if (arguments.recordings.empty()) arguments.recordings = {"synth:room"};
  std::vector<Section> sections;
  for (const std::string& source : arguments.recordings) {
    sections.push_back(BenchLasting(source, arguments.frames, arguments.sensor));
    PrintSection(sections.back());
  }
  WriteResult(arguments.out, "lasting", sections);
  return 0;
}

void AddLasting(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "lasting", "A recording played forth and back for hours: memory and time per frame");
  const auto arguments = std::make_shared<LastingArguments>();
  AddRecordings(*command, arguments->recordings, "Recordings (synth:room)");
  AddFrames(*command, arguments->frames, "Frames to track")->capture_default_str();
  command->add_option("--sensor", arguments->sensor, "Default: the recording's own")
      ->type_name("mono|stereo|rgbd");
  AddOut(*command, arguments->out);
  command->callback(
      [arguments, &action] { action = [arguments] { return RunLasting(*arguments); }; });
}

struct LargeMapArguments {
  std::string out;
  int keyframes = 10000;
};

void AddLargeMap(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "large-map", "A generated map of ten thousand keyframes: holding, changing, saving it");
  const auto arguments = std::make_shared<LargeMapArguments>();
  command->add_option("--keyframes", arguments->keyframes, "Keyframes of the map")
      ->check(CLI::Range(20, 1000000))
      ->capture_default_str();
  AddOut(*command, arguments->out);
  command->callback([arguments, &action] {
    action = [arguments] {
      const Section section = BenchLargeMap(arguments->keyframes);
      PrintSection(section);
      WriteResult(arguments->out, "large-map", {section});
      return 0;
    };
  });
}

}  // namespace

void AddScaleBenches(CLI::App& app, Action& action) {
  AddLasting(app, action);
  AddLargeMap(app, action);
}

}  // namespace alidade::bench
