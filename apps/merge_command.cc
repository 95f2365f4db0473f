// alidade merge: merges maps of several recordings of one place.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"
#include "alidade/run/merge/merge_inputs.h"
#include "alidade/run/merge/merge_outputs.h"
#include "commands.h"
#include "program/terminal.h"

namespace alidade {
namespace {

struct MergeArguments {
  std::vector<std::string> maps;
  std::string out;
  bool overwrite = false, quiet = false;
};

// "monday, tuesday and friday"
std::string AndOf(const std::vector<std::string>& names) {
  std::string all;
  for (size_t i = 0; i < names.size(); ++i)
    all += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return all;
}

void Tell(const std::vector<MergeInput>& inputs, const MergedMaps& merged,
          const MergePlaces& places) {
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (merged.camera_shifts[i] > 0)
      std::printf(
          "%s was made with another calibration of the camera (%.2g pixels apart, within its "
          "uncertainty): that of the largest map is used\n",
          inputs[i].name.c_str(), merged.camera_shifts[i]);
  }
  const std::vector<MergedWorld> worlds = WorldsOf(merged);
  for (const MergedWorld& world : worlds) {
    std::vector<std::string> names;
    for (size_t i : world.inputs) names.push_back(inputs[i].name);
    const char* what = names.size() > 1 ? "show the same place and are merged into one map"
                       : worlds.size() == 1
                           ? "is one map"
                           : "shares no place with the others and remains a separate map";
    std::printf("%s %s: %d keyframes, %d landmarks\n", AndOf(names).c_str(), what, world.keyframes,
                world.landmarks);
  }
  std::printf("%zu map%s of %zu recordings in %s, trajectories in %s\n", worlds.size(),
              worlds.size() == 1 ? "" : "s", inputs.size(), places.map.c_str(),
              places.folder.c_str());
}

int Merge(const MergeArguments& arguments) {
  const MergePlaces places = MergePlacesOf(arguments.out);
  if (!arguments.out.empty() && places.map == arguments.out && IsFolder(arguments.out))
    ThrowUsage("--out " + arguments.out + " is a folder, but has the name of a map file");
  const std::vector<MergeInput> inputs = ReadMergeInputs(arguments.maps);
  CheckMergePlaces(places, inputs, arguments.overwrite);
  Terminal terminal(arguments.quiet);
  Stopwatch clock;
  double shown_at = -1e9;
  const auto progress = [&](const char* what, int done, int total) {
    if (!terminal.shows_progress() || clock.Milliseconds() - shown_at < 100) return;
    shown_at = clock.Milliseconds();
    terminal.SetProgress(std::string(what) + ": keyframe " + std::to_string(done) + "/" +
                         std::to_string(total));
  };
  std::vector<MapToMerge> maps;
  for (const MergeInput& input : inputs) maps.push_back({input.path, input.saved});
  const MergedMaps merged = MergeMaps(maps, progress);
  terminal.SetProgress("");
  WriteMerge(places, inputs, merged);
  if (!arguments.quiet) Tell(inputs, merged, places);
  return 0;
}

}  // namespace

void AddMergeCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("merge", "Merge the maps of several recordings of one place");
  auto arguments = std::make_shared<MergeArguments>();
  command
      ->add_option("MAP", arguments->maps,
                   "Map files (map.alidade) or result folders of `alidade run`, two or more")
      ->required();
  command
      ->add_option(
          "--out", arguments->out,
          "Merged map: a file (.alidade), or a folder for map.alidade and the trajectories")
      ->type_name("MAP")
      ->required();
  command->add_flag("--overwrite", arguments->overwrite,
                    "Replace an existing result, even a map of other recordings");
  command->add_flag("--quiet", arguments->quiet, "Print errors only");
  command->footer(
      "\nExamples:\n  alidade merge alidade-out/monday alidade-out/tuesday --out house\n  alidade "
      "merge a.alidade b.alidade c.alidade --out all.alidade\n  alidade localize wednesday --map "
      "house/map.alidade\n\nMaps that show the same place are merged, in any order. Other maps "
      "remain separate in the same file, and are listed.\nThe world frame is that of the largest "
      "map. NAME.txt is the trajectory of each recording in it: all frames for a\nresult folder, "
      "keyframes for a map file (docs/guides/several-maps.md).");
  command->callback([arguments, &action] { action = [arguments] { return Merge(*arguments); }; });
}

}  // namespace alidade
