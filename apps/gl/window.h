// A window with a context of OpenGL ES 3, in which a recorded run is played.
#pragma once

#include <string>

#include "player.h"

namespace alidade::gl_app {

struct WindowSettings {
  int width = 1280, height = 720;  // pixels
  double speed = 1;                // of the recording; 0: all at once
  std::string screenshot;          // PNG of the end, no window is shown; empty: a window
};

// Until the window is closed. Throws Error (input) when none can be opened.
void ShowRun(StreamPlayer& player, const WindowSettings& settings);

}  // namespace alidade::gl_app
