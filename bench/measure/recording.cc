#include "bench/measure/recording.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "alidade/base/error.h"
#include "alidade/run/sources/synth_source.h"

namespace alidade::bench {

Recording LoadRecording(const std::string& source, int count) {
  SourceOptions options;
  options.last = count - 1;
  const auto opened =
      IsSynthSource(source) ? OpenSynthSource(source, options) : OpenSource(source, options);
  Recording recording{source, opened->Info(), {}};
  while (auto frame = opened->Next()) {
    if (frame->problem.empty()) recording.frames.push_back(std::move(*frame));
  }
  if (recording.frames.size() < 2) ThrowInput(source + " has fewer than 2 frames that can be read");
  return recording;
}

std::vector<std::string> RecordingsIn(const std::vector<std::string>& sources) {
  namespace fs = std::filesystem;
  std::vector<std::string> recordings;
  for (const std::string& source : sources) {
    std::vector<std::string> inside;
    std::error_code error;
    if (!fs::exists(source + "/rgb.txt", error)) {
      for (const auto& entry : fs::directory_iterator(source, error)) {
        if (fs::exists(entry.path() / "rgb.txt", error)) inside.push_back(entry.path().string());
      }
    }
    std::sort(inside.begin(), inside.end());
    if (inside.empty()) inside.push_back(source);
    recordings.insert(recordings.end(), inside.begin(), inside.end());
  }
  return recordings;
}

std::string ShortName(const std::string& source) {
  if (IsSynthSource(source)) return source;
  const std::filesystem::path path(source);
  const std::string name = path.filename().string();
  return name.empty() ? path.parent_path().filename().string() : name;
}

}  // namespace alidade::bench
