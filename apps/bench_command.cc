// `alidade bench`: how long the parts take, in milliseconds and in U (docs/benchmarks.md).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"
#include "arguments.h"
#include "bench/bench.h"
#include "bench/dynamic.h"
#include "bench/large_map.h"
#include "bench/lasting.h"
#include "bench/phone.h"
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

void Print(const bench::Section& section) {
  const Summary u = Summarise(section.u_milliseconds);
  if (u.count > 0) {
    std::printf("\n%s (U = %.2f ms, median of %d)\n", section.name.c_str(), u.median, u.count);
  } else {
    std::printf("\n%s\n", section.name.c_str());
  }
  if (!section.rows.empty())
    std::printf("  %-44s %10s %8s %10s %7s\n", "", "median ms", "U", "p95 ms", "times");
  for (const bench::Row& row : section.rows) {
    const Summary s = Summarise(row.milliseconds);
    char ratio[32] = "-";  // where no frame of OpenCV's was timed in turns
    if (u.count > 0) std::snprintf(ratio, sizeof ratio, "%.3f", s.median / u.median);
    std::printf("  %-44s %10.3f %8s %10.3f %7d  %s\n", row.name.c_str(), s.median, ratio, s.p95,
                s.count, row.note.c_str());
  }
  for (const bench::Table& table : section.tables) {
    std::printf("\n  %s\n", table.name.c_str());
    const bool labels = !table.labels.empty();
    const int width = labels ? 9 : 16, digits = labels ? 2 : 3;
    size_t longest = 24;
    for (const std::string& label : table.labels) longest = std::max(longest, label.size());
    const int label_width = static_cast<int>(longest);
    if (labels) std::printf("  %-*s", label_width, "");
    std::vector<int> widths;
    for (const std::string& column : table.columns) {
      widths.push_back(std::max(width, static_cast<int>(column.size())));
      std::printf("  %*s", widths.back(), column.c_str());
    }
    for (size_t i = 0; i < table.rows.size(); ++i) {
      std::printf("\n");
      if (labels) std::printf("  %-*s", label_width, table.labels[i].c_str());
      for (size_t column = 0; column < widths.size(); ++column) {
        const double value = table.rows[i][column];
        if (value == value) {
          std::printf("  %*.*f", widths[column], digits, value);
        } else {
          std::printf("  %*s", widths[column], "-");
        }
      }
    }
    std::printf("\n  %s\n", table.note.c_str());
  }
}

ordered_json ToJson(const bench::Section& section) {
  const Summary u = Summarise(section.u_milliseconds);
  ordered_json rows = ordered_json::array();
  for (const bench::Row& row : section.rows) {
    const Summary s = Summarise(row.milliseconds);
    rows.push_back({{"name", row.name},
                    {"median_ms", s.median},
                    {"p95_ms", s.p95},
                    {"median_u", u.count > 0 ? ordered_json(s.median / u.median) : ordered_json()},
                    {"count", s.count},
                    {"note", row.note}});
  }
  ordered_json made = {
      {"name", section.name}, {"u_ms", u.median}, {"u_count", u.count}, {"rows", rows}};
  for (const bench::Table& table : section.tables) {
    made["tables"].push_back({{"name", table.name},
                              {"columns", table.columns},
                              {"rows", table.rows},
                              {"note", table.note}});
    if (!table.labels.empty()) made["tables"].back()["labels"] = table.labels;
  }
  return made;
}

// `all`: what holds for all benches.
void Write(const std::string& path, ordered_json all, ordered_json sections) {
  if (path.empty()) return;
  all["benches"] = std::move(sections);
  AtomicWriteFile(path, all.dump(2) + "\n");
}

// `words`: recordings.
int RunSemiDense(std::vector<std::string> words, const BenchArguments& arguments) {
  if (!arguments.source.empty()) words.push_back(arguments.source);
  ordered_json sections = ordered_json::array();
  for (const std::string& source : bench::SemiDenseSources(words)) {
    const bench::Section section = bench::BenchSemiDense(source, arguments.frames);
    Print(section);
    std::fflush(stdout);
    sections.push_back(ToJson(section));
  }
  Write(arguments.out, {{"version", 1}, {"threads", ThreadCount()}}, std::move(sections));
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
  Print(section);
  Write(arguments.out, {{"version", 1}, {"threads", ThreadCount()}}, {ToJson(section)});
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
    Print(section);
    sections.push_back(ToJson(section));
  }
  Write(arguments.out, {{"version", 1}, {"threads", ThreadCount()}}, std::move(sections));
  return 0;
}

// `words`: recordings.
int RunPhone(std::vector<std::string> words, const BenchArguments& arguments) {
  if (!arguments.source.empty()) words.push_back(arguments.source);
  if (words.empty()) words.emplace_back("synth:room?frames=300");
  ordered_json sections = ordered_json::array();
  for (const std::string& source : words) {
    for (const bench::Section& section : bench::BenchPhone(source, arguments.frames)) {
      Print(section);
      sections.push_back(ToJson(section));
    }
    std::fflush(stdout);
  }
  Write(arguments.out, {{"version", 1}, {"threads", ThreadCount()}}, std::move(sections));
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
    Print(section);
    Write(arguments.out, {{"version", 1}, {"threads", ThreadCount()}}, {ToJson(section)});
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
    Print(section);
    std::fflush(stdout);
    sections.push_back(ToJson(section));
  }
  Write(arguments.out,
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
