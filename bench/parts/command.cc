#include <cstdio>
#include <memory>

#include "alidade/base/parallel.h"
#include "bench/benches.h"
#include "bench/measure/print.h"
#include "bench/measure/result_file.h"
#include "bench/options.h"
#include "bench/parts/parts.h"

namespace alidade::bench {
namespace {

struct Part {
  const char *name, *help;
  Section (*measure)(const Recording& recording);
  // Places need a path that comes back: one and a half times round the loop, two frames a second.
  const char* source = "synth:room";
  int frames = 150;
};

constexpr Part kParts[] = {
    {"frame", "A whole frame, threaded, fed at the recording's rate", BenchFrame},
    {"features", "Feature extraction and matching", BenchFeatures},
    {"ransac", "Homography and fundamental matrix of two views, in RANSAC", BenchRansac},
    {"ba", "Pose optimization, bundle adjustment, pose graph", BenchBundle},
    {"place", "Place recognition: time, precision and recall", BenchPlace,
     "synth:loop?fps=2&frames=192", 192},
};

struct PartArguments {
  std::string source, out;
  int frames = 0;
};

int RunPart(const Part& part, const PartArguments& arguments) {
  const Recording recording = LoadRecording(arguments.source, arguments.frames);
  const Camera& camera = recording.info.camera;
  std::printf("%s: %d frames of %dx%d pixels, %d threads\n", recording.source.c_str(),
              static_cast<int>(recording.frames.size()), camera.width, camera.height,
              ThreadCount());
  const Section section = part.measure(recording);
  PrintSection(section);
  WriteResult(arguments.out, part.name, {section});
  return 0;
}

}  // namespace

void AddPartBenches(CLI::App& app, Action& action) {
  for (const Part& part : kParts) {
    CLI::App* command = app.add_subcommand(part.name, part.help);
    const auto arguments = std::make_shared<PartArguments>();
    arguments->source = part.source;
    arguments->frames = part.frames;
    command->add_option("--source", arguments->source, "Recording to take frames from")
        ->type_name("PATH")
        ->capture_default_str();
    AddFrames(*command, arguments->frames, "Frames of it, at most")->capture_default_str();
    AddOut(*command, arguments->out);
    command->callback([&part, arguments, &action] {
      action = [&part, arguments] { return RunPart(part, *arguments); };
    });
  }
}

}  // namespace alidade::bench
