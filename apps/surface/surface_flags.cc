#include "surface/surface_flags.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "alidade/run/play/loop.h"
#include "program/program.h"
#include "program/terminal.h"

namespace alidade {

void AddSurfaceOptions(CLI::App& command, std::string& path, std::string& out,
                       DenseViewSettings& views, const char* out_help) {
  command.add_option("RESULT", path, "Result folder of `alidade run`, or its map.alidade")
      ->required()
      ->type_name("PATH");
  command.add_option("-o,--out", out, out_help)->type_name("OUT");
  command
      .add_option("--every", views.every, "Use each N-th frame with a pose; default: the keyframes")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000));
  command
      .add_option("--part", views.part,
                  "Number of the map, if there are several: 0 is the largest (see `alidade info`)")
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--source", views.source,
                  "Where the recording is now; default: where the run read it")
      ->type_name("PATH");
  command
      .add_option("--camera", views.camera,
                  "Calibration file of the recording; default: that of the run")
      ->type_name("FILE");
}

int RunSurfaceCommand(const std::function<std::string(const ExportProgress&)>& write) {
  CatchInterrupts();
  Terminal terminal(false);
  const auto progress = [&](int frames, int total) {
    if (terminal.shows_progress())
      terminal.SetProgress("frame " + std::to_string(frames) + "/" + std::to_string(total));
    return !Interrupted();
  };
  try {
    const std::string what = write(progress);
    terminal.SetProgress("");
    std::printf("%s\n", what.c_str());
    return 0;
  } catch (const ExportStopped&) {
    terminal.SetProgress("");
    return kInterruptedStatus;
  }
}

}  // namespace alidade
