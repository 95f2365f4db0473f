// Plays a recorded run in a window with OpenGL ES 3.
#pragma once

#include <string>

#include "player.h"

namespace alidade::gl_app {

struct WindowSettings {
  int width = 1280, height = 720;  // pixels
  double speed = 1;                // relative to the recording; 0: show the end at once
  std::string screenshot;          // write a PNG of the end without a window; empty: open a window
};

// Returns when the window is closed. Throws Error (input) if none can be opened.
void ShowRun(StreamPlayer& player, const WindowSettings& settings);

}  // namespace alidade::gl_app
