#include <memory>

#include "bench/benches.h"
#include "bench/measure/print.h"
#include "bench/measure/recording.h"
#include "bench/measure/result_file.h"
#include "bench/options.h"
#include "bench/semidense/semidense.h"

namespace alidade::bench {
namespace {

struct SemiDenseArguments {
  std::vector<std::string> recordings;
  std::string out;
  int frames = 0;
};

int RunSemiDense(const SemiDenseArguments& arguments) {
  std::vector<std::string> recordings = RecordingsIn(arguments.recordings);
  if (recordings.empty()) recordings = {"synth:room", "synth:desk", "synth:wall"};
  std::vector<Section> sections;
  for (const std::string& source : recordings) {
    sections.push_back(BenchSemiDense(source, arguments.frames));
    PrintSection(sections.back());
  }
  WriteResult(arguments.out, "semidense", sections);
  return 0;
}

}  // namespace

void AddSemiDenseBench(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "semidense", "Semi-dense depth: how right, how much of it, and at what cost");
  const auto arguments = std::make_shared<SemiDenseArguments>();
  AddRecordings(*command, arguments->recordings,
                "Recordings with depth, or folders of them (synth:room, synth:desk, synth:wall)");
  AddFrames(*command, arguments->frames, "Frames of each, at most (200; recorded ones 600)");
  AddOut(*command, arguments->out);
  command->callback(
      [arguments, &action] { action = [arguments] { return RunSemiDense(*arguments); }; });
}

}  // namespace alidade::bench
