// `alidade bench`: how long the parts take, in milliseconds and in U (docs/benchmarks/index.md).
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "arguments.h"
#include "bench/bench.h"
#include "bench/dynamic.h"
#include "bench/large_map.h"
#include "bench/lasting.h"
#include "bench/phone.h"
#include "bench/section_output.h"
#include "bench/semidense.h"
#include "bench/wild.h"
#include "commands.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

struct BenchArguments {
  std::vector<std::string> names;
  std::string source, out;
  int frames = 0;  // 0: see FillIn()
  int seeds = 0;   // 0: dynamic 1, wild 3
  std::vector<std::string> settings;
  bench::DynamicOptions dynamic;
  bench::WildOptions wild;
};

using Bench = bench::Section (*)(const bench::Recording&);

Bench BenchNamed(const std::string& name) {
  return Choice<Bench>("NAME", name,
                       {{"features", bench::BenchFeatures},
                        {"ransac", bench::BenchRansac},
                        {"ba", bench::BenchBundle},
                        {"frame", bench::BenchFrame},
                        {"place", bench::BenchPlace}});
}

// What is measured when nothing else is said. Places need a way that comes back: one and a half
// times round the loop, two frames a second.
void FillIn(BenchArguments& arguments) {
  const bool place = arguments.names == std::vector<std::string>{"place"};
  if (arguments.frames == 0) arguments.frames = place && arguments.source.empty() ? 192 : 150;
  if (arguments.source.empty()) {
    arguments.source = place ? "synth:loop?fps=2&frames=192" : "synth:room";
  }
}

// `words`: recordings.
int RunSemiDense(std::vector<std::string> words, const BenchArguments& arguments) {
  if (!arguments.source.empty()) words.push_back(arguments.source);
  ordered_json sections = ordered_json::array();
  for (const std::string& source : bench::SemiDenseSources(words)) {
    const bench::Section section = bench::BenchSemiDense(source, arguments.frames);
    bench::PrintSection(section);
    std::fflush(stdout);
    sections.push_back(bench::SectionJson(section));
  }
  bench::WriteSections(arguments.out, {{"version", 1}, {"threads", ThreadCount()}},
                       std::move(sections));
  return 0;
}

// `words`: recordings.
int RunDynamic(const std::vector<std::string>& words, BenchArguments arguments) {
  bench::DynamicOptions& options = arguments.dynamic;
  options.sources = words;
  if (!arguments.source.empty()) options.sources.push_back(arguments.source);
  options.frames = arguments.frames;
  options.settings = arguments.settings;
  if (arguments.seeds > 0) options.seeds = arguments.seeds;
  const bench::Section section = bench::BenchDynamic(options);
  bench::PrintSection(section);
  bench::WriteSections(arguments.out, {{"version", 1}, {"threads", ThreadCount()}},
                       {bench::SectionJson(section)});
  return 0;
}

// `words`: recordings.
int RunLasting(std::vector<std::string> words, const BenchArguments& arguments) {
  if (!arguments.source.empty()) words.push_back(arguments.source);
  if (words.empty()) words.emplace_back("synth:room");
  const auto& sensors = arguments.dynamic.sensors;
  ordered_json sections = ordered_json::array();
  for (const std::string& source : words) {
    const bench::Section section =
        bench::BenchLasting(source, arguments.frames, sensors.empty() ? "" : sensors.front());
    bench::PrintSection(section);
    sections.push_back(bench::SectionJson(section));
  }
  bench::WriteSections(arguments.out, {{"version", 1}, {"threads", ThreadCount()}},
                       std::move(sections));
  return 0;
}

// `words`: recordings.
int RunPhone(std::vector<std::string> words, const BenchArguments& arguments) {
  if (!arguments.source.empty()) words.push_back(arguments.source);
  if (words.empty()) words.emplace_back("synth:room?frames=300");
  ordered_json sections = ordered_json::array();
  for (const std::string& source : words) {
    for (const bench::Section& section : bench::BenchPhone(source, arguments.frames)) {
      bench::PrintSection(section);
      sections.push_back(bench::SectionJson(section));
    }
    std::fflush(stdout);
  }
  bench::WriteSections(arguments.out, {{"version", 1}, {"threads", ThreadCount()}},
                       std::move(sections));
  return 0;
}

int RunWild(BenchArguments arguments) {
  if (arguments.names.size() > 1) ThrowUsage("bench wild takes no recordings: it renders its own");
  bench::WildOptions& options = arguments.wild;
  options.settings = arguments.settings;
  options.out = arguments.out;
  options.frames = arguments.frames;
  if (arguments.seeds > 0) options.seeds = arguments.seeds;
  return bench::BenchWild(options);
}

int Run(BenchArguments arguments) {
  cv::setNumThreads(1);
  SetThreadCount(0);
  const std::vector<std::string>& names = arguments.names;
  if (names[0] == "semidense") return RunSemiDense({names.begin() + 1, names.end()}, arguments);
  if (names[0] == "dynamic") return RunDynamic({names.begin() + 1, names.end()}, arguments);
  if (names[0] == "wild") return RunWild(arguments);
  if (names[0] == "phone") return RunPhone({names.begin() + 1, names.end()}, arguments);
  if (names[0] == "lasting") return RunLasting({names.begin() + 1, names.end()}, arguments);
  if (names[0] == "large-map") {
    const bench::Section section = bench::BenchLargeMap(arguments.frames);
    bench::PrintSection(section);
    bench::WriteSections(arguments.out, {{"version", 1}, {"threads", ThreadCount()}},
                         {bench::SectionJson(section)});
    return 0;
  }
  FillIn(arguments);
  std::vector<Bench> benches;
  for (const std::string& name : arguments.names) benches.push_back(BenchNamed(name));
  const bench::Recording recording = bench::LoadRecording(arguments.source, arguments.frames);
  const Camera& camera = recording.info.camera;
  std::printf(
      "%s: %d frames of %dx%d pixels, %d threads. U: cv::ORB, 1000 features, one thread, same "
      "frames.\n",
      recording.source.c_str(), static_cast<int>(recording.frames.size()), camera.width,
      camera.height, ThreadCount());
  ordered_json sections = ordered_json::array();
  for (Bench bench : benches) {
    const bench::Section section = bench(recording);
    bench::PrintSection(section);
    std::fflush(stdout);
    sections.push_back(bench::SectionJson(section));
  }
  bench::WriteSections(arguments.out,
                       {{"version", 1},
                        {"source", recording.source},
                        {"frames", recording.frames.size()},
                        {"width", camera.width},
                        {"height", camera.height},
                        {"threads", ThreadCount()}},
                       std::move(sections));
  return 0;
}

// Of several runs, which have settings.
void AddRunOptions(CLI::App& command, BenchArguments& arguments) {
  command.add_option("--seeds", arguments.seeds, "Runs of each kind (dynamic: 1, wild: 3)")
      ->check(CLI::Range(1, 100))
      ->group("Of dynamic and wild");
  command.add_option("--set", arguments.settings, "One setting of all runs")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group("Of dynamic and wild");
}

void AddWildOptions(CLI::App& command, bench::WildOptions& options) {
  const std::string group = "Of wild";
  command.add_option("--cases", options.cases, "Which, with commas between them; default: all")
      ->group(group);
  command.add_option("--profile", options.profile, "Of all cases")
      ->type_name("desktop|phone")
      ->group(group);
  command.add_flag("--check", options.check, "End with status 1 when there is a false pose or map")
      ->group(group);
}

void AddDynamicOptions(CLI::App& command, bench::DynamicOptions& options) {
  const auto add = [&](const std::string& name, auto& value, const std::string& help) {
    return command.add_option(name, value, help)->group("Of dynamic");
  };
  const auto many = [&](const std::string& name, std::vector<std::string>& values,
                        const std::string& help) {
    add(name, values, help)
        ->take_all()
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  const auto flag = [&](const std::string& name, bool& value, const std::string& help) {
    command.add_flag(name, value, help)->group("Of dynamic");
  };
  add("--detector", options.detector, "Network that finds people (.onnx), for mode full")
      ->type_name("FILE");
  add("--camera", options.camera, "Calibration (camera.yaml) instead of the recordings' own")
      ->type_name("FILE");
  many("--sensor", options.sensors, "rgbd, stereo, mono; default: the recording's own, and mono");
  many("--plain", options.plain,
       "The same frames without people, DIR or DIR:first-last, for each recording");
  flag("--ablation", options.ablation, "What each part is worth");
  flag("--latency", options.latency, "Late and lost detections");
  flag("!--no-live", options.live, "Leave out the threaded runs, which take their time");
  add("--pictures", options.pictures, "Folder for pictures of the features, before and after")
      ->type_name("FOLDER");
}

}  // namespace

void AddBenchCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("bench", "Time the parts, beside OpenCV's ORB on the same frames");
  auto arguments = std::make_shared<BenchArguments>();
  command
      ->add_option("NAME", arguments->names,
                   "features, ransac, ba, frame, place: one or more; or semidense and recordings "
                   "with depth (synth:room, synth:desk, synth:wall); or dynamic and recordings of "
                   "people (synth:room?actors=3); or lasting and recordings to be played forth and "
                   "back for hours (--sensor; --frames 20000); or large-map (--frames 10000: "
                   "keyframes); or wild; or phone and recordings of one camera: what the phone's "
                   "parameters and threads are worth")
      ->required()
      ->type_name(
          "features|ransac|ba|frame|place|semidense|dynamic|lasting|large-map|wild|phone|PATH");
  command
      ->add_option("--source", arguments->source,
                   "Recording to take frames from (synth:room; place: synth:loop)")
      ->type_name("PATH");
  command
      ->add_option("--frames", arguments->frames,
                   "Frames of it, at most (150; semidense: 200, recorded ones 600; dynamic: 200, "
                   "recorded ones all; lasting: 20000; wild: all the case has; phone: 600)")
      ->check(CLI::Range(2, 100000000));
  AddRunOptions(*command, *arguments);
  AddDynamicOptions(*command, arguments->dynamic);
  AddWildOptions(*command, arguments->wild);
  command->add_option("--out", arguments->out, "JSON file to write the numbers to")
      ->type_name("FILE");
  command->callback([arguments, &action] { action = [arguments] { return Run(*arguments); }; });
}

}  // namespace alidade
