// alidade-gl: a recorded run in a window, drawn by the renderer that the Android app has.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "alidade/base/error.h"
#include "alidade/version.h"
#include "player.h"
#include "window.h"

namespace {

int Main(int argc, char** argv) {
  CLI::App app("Plays a recorded run in a window with OpenGL ES 3");
  app.name("alidade-gl");
  app.set_version_flag("--version", "alidade-gl " ALIDADE_VERSION);
  std::string what, size;
  alidade::gl_app::WindowSettings settings;
  app.add_option("RUN", what, "Result folder with a recorded stream, or the stream (run.stream)")
      ->required();
  app.add_option("--speed", settings.speed,
                 "Playback speed relative to the recording; 0: show the end at once")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--width", settings.width, "Pixels of the window")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  app.add_option("--height", settings.height, "Pixels of the window")
      ->check(CLI::Range(1, 16384))
      ->capture_default_str();
  app.add_option("--screenshot", settings.screenshot,
                 "Write an image (PNG) of the end of the run, and open no window");
  app.footer(
      "\nExamples:\n  alidade run kitchen --record && alidade-gl alidade-out/kitchen\n  alidade-gl "
      "alidade-out/kitchen --screenshot kitchen.png\n\nLeft button rotates, right button moves, "
      "wheel zooms; space pauses, F shows the whole map;\nL landmarks, P semi-dense points, K "
      "keyframes, T trajectory, M features, O other maps; Q ends.\nThe window's title shows the "
      "numbers of keyframes, points and matches.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  alidade::gl_app::StreamPlayer player(what);
  ShowRun(player, settings);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Main(argc, argv);
  } catch (const alidade::Error& error) {
    std::fprintf(stderr, "alidade-gl: %s\n", error.what());
    return static_cast<int>(error.kind());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "alidade-gl: internal error (a bug, please report it): %s\n",
                 error.what());
    return 70;
  }
}
