// Frames of a recording, held in memory.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/frame_source.h"

namespace alidade::bench {

struct Recording {
  std::string source;
  SourceInfo info;
  std::vector<SourceFrame> frames;  // that could be read
};

// `count` frames at most, from the first on. Throws Error (input) when there are fewer than 2.
Recording LoadRecording(const std::string& source, int count);

// A folder that holds several recordings (each with an rgb.txt) stands for all of them, in order of
// name.
std::vector<std::string> RecordingsIn(const std::vector<std::string>& sources);

// The name of its folder or file; of a rendered one all of it.
std::string ShortName(const std::string& source);

}  // namespace alidade::bench
