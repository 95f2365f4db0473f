// Writes rendered recordings in the layouts of known datasets (docs/reference/sources.md), always
// with depth and masks.
#pragma once

#include <memory>
#include <string>

#include "alidade/synth/recording.h"
#include "synth/imu_text.h"

namespace alidade {

enum class SynthFormat { kTum, kEuroc, kKitti };

class SynthWriter {
 public:
  virtual ~SynthWriter() = default;
  // Adds the next frame; frames are numbered from 0.
  virtual void Add(const RenderedFrame& frame, const Se3& T_world_camera) = 0;
  // All readings of the inertial sensor, on its clock. Throws Error (usage) if the format has none.
  virtual void AddReadings(const WrittenImu& imu) = 0;
  // Writes lists, poses and calibration. Before that, no reader recognizes the folder as a
  // recording.
  virtual void Finish() = 0;
};

// The folder must exist. `fisheye`: equidistant lens (kTum only). Throws Error (input) if a file
// cannot be written.
std::unique_ptr<SynthWriter> MakeSynthWriter(SynthFormat format, const std::string& folder,
                                             const Camera& camera, bool fisheye);

// First time stamp of recordings in EuRoC's format, seconds since 1970.
inline constexpr int kSynthEurocStart = 1'000'000'000;

}  // namespace alidade
