#include "alidade/run/sources/inspect.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/print.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/pair_check.h"

namespace alidade {
namespace {

constexpr int kDepthImages = 10;
constexpr double kTail = 0.05;                      // of the depths, outside the range that is told
constexpr double kNearest = 0.05, kFarthest = 100;  // meters: depth cameras measure in between
constexpr double kWidestPair = 3;        // meters: stereo cameras have a smaller baseline
constexpr double kMostOffCenter = 0.08;  // of the image's side; lenses are centered to 5 %
constexpr double kMostStretched = 1.05;  // fx / fy; pixels are square

std::string Meters(double meters) {
  char text[32];
  PrintTo(text, sizeof(text), meters < 10 ? "%.2g" : "%.0f", meters);
  return text;
}

// Depths in meters of every 16th pixel, zeros and NaN left out.
void AddDepths(const cv::Mat& depth, double factor, std::vector<double>& depths) {
  for (int y = 2; y < depth.rows; y += 4) {
    for (int x = 2; x < depth.cols; x += 4) {
      const double z =
          depth.type() == CV_16UC1 ? depth.at<uint16_t>(y, x) / factor : depth.at<float>(y, x);
      if (std::isfinite(z) && z > 0) depths.push_back(z);
    }
  }
}

void InspectDepth(FrameSource& source, SourceFindings& findings) {
  const SourceInfo& info = source.Info();
  if (info.frames <= 0 || !source.Seek(0)) return;
  std::vector<double> depths;
  std::string problem;
  bool stored = false, any = false;
  const int images = std::min(kDepthImages, info.frames);
  for (int k = 0; k < images; ++k) {
    if (!source.Seek(static_cast<int>(static_cast<int64_t>(k) * info.frames / images))) break;
    const std::optional<SourceFrame> frame = source.Next();
    if (!frame) break;
    if (problem.empty()) problem = frame->incomplete;
    if (frame->depth.empty()) continue;
    any = true;
    stored = stored || frame->depth.type() == CV_16UC1;
    AddDepths(frame->depth, info.camera.depth_factor, depths);
  }
  source.Seek(0);
  if (!any && !problem.empty()) {
    findings.unusable = problem;
    return;
  }
  if (depths.empty()) return;
  std::sort(depths.begin(), depths.end());
  const auto at = [&](double share) {
    return depths[static_cast<size_t>(share * static_cast<double>(depths.size() - 1))];
  };
  findings.told = "Depth from " + Meters(at(kTail)) + " to " + Meters(at(1 - kTail)) + " m";
  char factor[80] = "";
  if (stored) {
    PrintTo(factor, sizeof(factor), ", %g units per meter%s", info.camera.depth_factor,
            info.depth_assumed ? " assumed (`depth_factor` in the camera file)" : "");
    findings.told += factor;
  }
  if (at(0.5) < kNearest || at(0.5) > kFarthest) {
    LogWarning("the depth images show distances from " + Meters(at(kTail)) + " to " +
               Meters(at(1 - kTail)) + " m, which no depth camera measures: is `depth_factor` " +
               "right (1000 for millimeters)? It sets the scale of the trajectory");
  }
}

void InspectCamera(const SourceInfo& info) {
  const Camera& camera = info.camera;
  if (camera.baseline > kWidestPair) {
    LogWarning("the two cameras are " + Meters(camera.baseline) +
               " m apart: is the baseline in millimeters? It sets the scale of the trajectory");
  }
  const double off_x = (camera.cx - (camera.width - 1) / 2.0) / camera.width;
  const double off_y = (camera.cy - (camera.height - 1) / 2.0) / camera.height;
  const double off = std::abs(off_x) > std::abs(off_y) ? off_x : off_y;
  char text[160];
  if (info.sensor != Sensor::kStereo && std::abs(off) > kMostOffCenter) {
    PrintTo(text, sizeof(text),
            "the principal point lies %.0f %% of the image's side off its center: does "
            "the calibration belong to a cropped image, or to another camera?",
            100 * std::abs(off));
    LogWarning(text);
  }
  const double stretched = std::max(camera.fx / camera.fy, camera.fy / camera.fx);
  if (stretched > kMostStretched) {
    PrintTo(text, sizeof(text),
            "the focal lengths fx and fy differ by %.0f %%: does the calibration belong to "
            "these images?",
            100 * (stretched - 1));
    LogWarning(text);
  }
}

void Append(std::string& told, const std::string& more) {
  if (more.empty()) return;
  told += (told.empty() ? "" : "\n") + more;
}

}  // namespace

InspectedSource OpenInspected(const std::string& path, SourceOptions& wanted) {
  InspectedSource inspected;
  inspected.source = OpenAnySource(path, wanted);
  SourceFindings findings = Inspect(*inspected.source);
  if (!findings.unusable.empty()) {
    const std::string sensor = NameOf(inspected.source->Info().sensor);
    if (wanted.sensor)
      ThrowInput("--sensor " + sensor + ": " + findings.unusable + " (--sensor mono uses the " +
                 (sensor == "stereo" ? "left images" : "images") + " alone)");
    LogWarning(findings.unusable + ": one camera alone is used instead of " + sensor);
    wanted.sensor = Sensor::kMono;
    inspected.source = OpenAnySource(path, wanted);
  }
  const SourceInfo& info = inspected.source->Info();
  inspected.told = info.told;
  Append(inspected.told, findings.told);
  if (info.fps_assumed)
    Append(inspected.told, "30 images per second assumed (`fps` in the camera file)");
  return inspected;
}

SourceFindings Inspect(FrameSource& source) {
  SourceFindings findings;
  const SourceInfo& info = source.Info();
  if (info.kind == "synth") return findings;
  InspectCamera(info);
  if (info.sensor == Sensor::kRgbd) InspectDepth(source, findings);
  if (info.sensor == Sensor::kStereo) {
    const PairVerdict verdict = CheckPairs(source);
    source.Seek(0);
    if (verdict.fault == PairFault::kRowsOff) {
      LogWarning(PairInWords(verdict));
    } else {
      findings.unusable = PairInWords(verdict);
    }
  }
  return findings;
}

}  // namespace alidade
