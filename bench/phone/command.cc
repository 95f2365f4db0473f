#include <memory>

#include "bench/benches.h"
#include "bench/measure/print.h"
#include "bench/measure/result_file.h"
#include "bench/options.h"
#include "bench/phone/phone.h"

namespace alidade::bench {
namespace {

struct PhoneArguments {
  std::vector<std::string> recordings;
  std::string out;
  int frames = 600;
};

int RunPhone(PhoneArguments arguments) {
  if (arguments.recordings.empty()) arguments.recordings = {"synth:room?frames=300"};
  std::vector<Section> sections;
  for (const std::string& source : arguments.recordings) {
    for (Section& section : BenchPhone(source, arguments.frames)) {
      PrintSection(section);
      sections.push_back(std::move(section));
    }
  }
  WriteResult(arguments.out, "phone", sections);
  return 0;
}

}  // namespace

void AddPhoneBench(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "phone", "What the phone's parameters and threads are worth, native and as WebAssembly");
  const auto arguments = std::make_shared<PhoneArguments>();
  AddRecordings(*command, arguments->recordings,
                "Recordings of one camera (synth:room?frames=300)");
  AddFrames(*command, arguments->frames, "Frames of each, at most")->capture_default_str();
  AddOut(*command, arguments->out);
  command->callback(
      [arguments, &action] { action = [arguments] { return RunPhone(*arguments); }; });
}

}  // namespace alidade::bench
