#include "true_depth.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/synth_source.h"
#include "synth/synth_folder.h"
#include "synth/synth_writer.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

// The `synth:` source that renders the frames of a recording of `alidade synth`.
std::string SynthSourceOf(const std::string& marker) {
  const auto about = nlohmann::json::parse(ReadFile(marker), nullptr, false);
  const auto damaged = [&] {
    ThrowInput(marker + " does not contain how the frames were rendered");
  };
  if (!about.is_object() || !about.contains("settings")) damaged();
  const auto& settings = about["settings"];
  if (!settings.is_object() || !settings.contains("scene") || !settings["scene"].is_string())
    damaged();
  std::string source = "synth:" + settings["scene"].get<std::string>() + "?";
  for (const auto& [name, value] : settings.items()) {
    if (name == "scene") continue;
    source += name + "=" + (value.is_string() ? value.get<std::string>() : value.dump()) + "&";
  }
  try {
    ParseSynthSource(source);
  } catch (const Error& error) {
    ThrowInput(marker + ": " + error.what());
  }
  return source;
}

}  // namespace

TrueDepthSource::TrueDepthSource(const std::string& sequence, std::optional<Sensor> sensor,
                                 const std::optional<std::string>& camera_file) {
  const std::string marker = sequence + "/" + kSynthMarker;
  const bool on_disk = IsFile(marker);
  rendered_ = on_disk || IsSynthSource(sequence);
  SourceOptions options;
  options.camera_file = camera_file;
  // A stereo pair with distortion is rectified, a single camera is not.
  if (rendered_ && sensor != Sensor::kStereo) options.sensor = sensor;
  source_ = OpenAnySource(on_disk ? SynthSourceOf(marker) : sequence, options);
  if (!rendered_ && source_->Info().sensor != Sensor::kRgbd)
    ThrowInput(sequence + " has no depth to compare with");
  if (on_disk && IsFolder(sequence + "/mav0")) time_offset_ = -kSynthEurocStart;
  finder_ = std::make_unique<FrameFinder>(*source_);
}

std::optional<TrueDepth> TrueDepthSource::At(double time, double max_dt) {
  const auto frame = finder_->Nearest(time + time_offset_, max_dt);
  if (!frame) return std::nullopt;
  if (!frame->problem.empty()) LogWarning(frame->problem);
  TrueDepth result{frame->image, rendered_ ? frame->true_depth : frame->depth};
  if (result.depth.type() == CV_16U)
    result.depth.convertTo(result.depth, CV_32F, 1 / source_->Info().camera.depth_factor);
  return result;
}

}  // namespace alidade
