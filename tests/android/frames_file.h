// Grey pictures as one file that needs no codec: what the same tests read as C++ here, as C++ on
// another processor, and as Java. A line of text, "alidade-frames width height count fx fy cx cy",
// then for each picture its time (f64, seconds, little endian) and its pixels, row after row.
#pragma once

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/geometry/camera.h"

namespace alidade {

struct GreyFrame {
  double time = 0;  // seconds
  std::vector<uint8_t> pixels;
};

struct FramesFile {
  Camera camera;
  std::vector<GreyFrame> frames;
};

inline FramesFile ReadFrames(const std::string& path) {
  FramesFile file;
  std::ifstream stream(path, std::ios::binary);
  std::string line, word;
  std::getline(stream, line);
  std::istringstream head(line);
  size_t count = 0;
  Camera& camera = file.camera;
  head >> word >> camera.width >> camera.height >> count >> camera.fx >> camera.fy >> camera.cx >>
      camera.cy;
  if (!head || word != "alidade-frames") ThrowInput(path + ": no pictures of alidade_frames");
  file.frames.resize(count);
  for (GreyFrame& frame : file.frames) {
    frame.pixels.resize(static_cast<size_t>(camera.width) * camera.height);
    stream.read(reinterpret_cast<char*>(&frame.time), sizeof(frame.time));
    stream.read(reinterpret_cast<char*>(frame.pixels.data()),
                static_cast<std::streamsize>(frame.pixels.size()));
  }
  if (!stream) ThrowInput(path + ": it ends early");
  return file;
}

}  // namespace alidade
