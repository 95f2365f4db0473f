// Writes rendered recordings to disk, laid out as known datasets are (docs/reference/sources.md),
// with depth and masks always.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "alidade/run/draft_folder.h"
#include "alidade/run/folder_lock.h"
#include "alidade/synth/recording.h"

namespace alidade {

enum class SynthFormat { kTum, kEuroc, kKitti };

class SynthWriter {
 public:
  virtual ~SynthWriter() = default;
  // Frames in order, from 0.
  virtual void Add(const RenderedFrame& frame, const Se3& T_world_camera) = 0;
  // Lists, poses and calibration: until then no reader takes the folder for a recording.
  virtual void Finish() = 0;
};

// The folder must be there. `fisheye`: the camera's lens is an equidistant one (kTum alone). Throws
// Error (input) when a file cannot be written.
std::unique_ptr<SynthWriter> MakeSynthWriter(SynthFormat format, const std::string& folder,
                                             const Camera& camera, bool fisheye);

// The folder of a recording, locked. The new one is gathered beside an earlier one of ours and takes
// its place when it is whole; files that are not ours stay.
class SynthFolder {
 public:
  // Makes the folder. Throws Error (input) when it holds anything else than a recording of ours.
  explicit SynthFolder(const std::string& path);
  const std::string& draft() const { return draft_->path(); }
  void Place();  // throws Error (input)

 private:
  const std::string path_;
  std::optional<FolderLock> lock_;
  std::optional<DraftFolder> draft_;
};

// The file that says a folder is ours.
inline constexpr char kSynthMarker[] = "synth.json";

// EuRoC recordings count from 1970: when ours begin, seconds.
inline constexpr int kSynthEurocStart = 1'000'000'000;

}  // namespace alidade
