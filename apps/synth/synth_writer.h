// Writes rendered recordings to disk, laid out as known datasets are (docs/reference/sources.md),
// with depth and masks always.
#pragma once

#include <memory>
#include <string>

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

// EuRoC recordings count from 1970: when ours begin, seconds.
inline constexpr int kSynthEurocStart = 1'000'000'000;

}  // namespace alidade
