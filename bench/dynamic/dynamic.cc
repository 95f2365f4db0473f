#include "bench/dynamic/dynamic.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>

#include "alidade/base/error.h"
#include "alidade/detect/class_names.h"
#include "alidade/detect/onnx/open_detector.h"
#include "alidade/io/files/image_file.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/sources/synth_source.h"
#include "bench/dynamic/live.h"
#include "bench/dynamic/pictures.h"
#include "bench/dynamic/remembering_detector.h"
#include "bench/dynamic/tables.h"
#include "bench/measure/recording.h"

namespace alidade::bench {
namespace {

constexpr int kRenderedFrames = 200;  // where nothing else is said

using Boxes = std::vector<std::vector<cv::Rect>>;  // of each frame

std::vector<std::string> SourcesOf(const DynamicOptions& options) {
  if (options.sources.empty()) return {"synth:room?actors=3", "synth:room?actors=3&stereo"};
  return RecordingsIn(options.sources);
}

// A recording, or part of one: DIR:first-last.
struct Part {
  std::string source;
  int first = 0, last = -1;
};

Part PartNamed(const std::string& word) {
  Part part{word};
  int first = 0, last = 0, read = 0;
  const size_t colon = word.rfind(':');
  if (colon == std::string::npos) return part;
  if (std::sscanf(word.c_str() + colon, ":%d-%d%n", &first, &last, &read) != 2 ||
      colon + static_cast<size_t>(read) != word.size())
    return part;
  return {word.substr(0, colon), first, last};
}

// The same frames without people: rendered ones can be had without being asked for.
std::optional<Part> PlainOf(const DynamicOptions& options, const std::string& source, size_t i) {
  if (i < options.plain.size()) return PartNamed(options.plain[i]);
  if (IsSynthSource(source) && ParseSynthSource(source).actors > 0)
    return Part{source + "&actors=0"};  // the last word holds
  return std::nullopt;
}

std::vector<Sensor> SensorsOf(const DynamicOptions& options, Sensor best) {
  std::vector<Sensor> sensors;
  if (options.sensors.empty()) {
    sensors.push_back(best);
    // Of our own two rooms the images are the same.
    const bool again = options.sources.empty() && best == Sensor::kStereo;
    if (best != Sensor::kMono && !again) sensors.push_back(Sensor::kMono);
  }
  for (const std::string& word : options.sensors) {
    const Sensor sensor = SensorNamed("--sensor", word);
    if (sensor == best || sensor == Sensor::kMono) sensors.push_back(sensor);
  }
  return sensors;
}

// Boxes of things that move by themselves, in every frame: by a detector that is never late.
Boxes DetectEverywhere(const DynamicScene& scene, const DynamicsSettings& settings,
                       Detector& detector) {
  Boxes boxes;
  for (const SourceFrame& frame : scene.frames) {
    boxes.emplace_back();
    for (const Detection& found :
         detector.Detect(frame.color.empty() ? frame.image : frame.color)) {
      const std::string& name = detector.ClassNames()[static_cast<size_t>(found.class_id)];
      if (IsListed(settings.moving_classes, name)) boxes.back().push_back(found.box);
    }
  }
  return boxes;
}

void AddBoxes(const DynamicScene& scene, const Boxes& detected, DynamicCase& of) {
  for (size_t i = 0; i < scene.masks.size(); ++i) {
    const cv::Mat& truth = scene.masks[i];
    if (truth.empty()) continue;
    AddOverlap(truth, Filled(truth.size(), scene.people[i]), of.people_boxes);
    if (!detected.empty()) AddOverlap(truth, Filled(truth.size(), detected[i]), of.detected_boxes);
  }
}

// The poses of `a` at times `b` has too.
Trajectory Common(const Trajectory& a, const Trajectory& b) {
  Trajectory common;
  for (const StampedPose& pose : a) {
    const auto same = [&](const StampedPose& other) { return other.time == pose.time; };
    if (std::any_of(b.begin(), b.end(), same)) common.push_back(pose);
  }
  return common;
}

double AteOf(const Trajectory& truth, const Trajectory& estimate, Sensor sensor) {
  AteSettings settings;
  settings.align = sensor == Sensor::kMono ? Alignment::kSim3 : Alignment::kSe3;
  try {
    return EvaluateAte(truth, estimate, settings).error.rmse;
  } catch (const Error&) {  // too few poses
    return std::numeric_limits<double>::quiet_NaN();
  }
}

Case CaseOf(const DynamicScene& scene, Sensor sensor) {
  Case of{scene.name, NameOf(sensor), "desktop"};
  of.source = scene.source;
  of.frames = static_cast<int>(scene.frames.size());
  return of;
}

// Everything that is measured on one recording with one sensor.
class Study {
 public:
  Study(const DynamicOptions& options, SlamSettings settings, std::shared_ptr<Detector> detector)
      : options_(options), settings_(std::move(settings)), detector_(std::move(detector)) {}

  // Runs that were made before, under whatever name, are not made again.
  DynamicVariant Run(const std::string& name, const DynamicScene& scene, const Boxes& detected,
                     SlamSettings settings, const FrameVisitor& visit = nullptr) {
    DynamicVariant variant{name, {}, {}, {}};
    settings.seed = settings_.seed;
    std::string key = scene.source + " " + std::to_string(scene.frames.front().number) + " " +
                      std::to_string(scene.frames.size());
    for (const auto& [field, value] : settings.All()) key += " " + value;
    key += NameOf(settings.sensor);
    std::vector<DynamicRun>& known = known_[key];
    if (!known.empty()) {
      variant.runs = known;
      return variant;
    }
    for (int i = 0; i < options_.seeds; ++i) {
      settings.seed = settings_.seed + static_cast<uint64_t>(i);
      variant.runs.push_back(
          RunDynamic(scene, settings, detector_, detected, i == 0 ? visit : nullptr));
      const DynamicRun& run = variant.runs.back();
      std::printf("%s %s, %s, seed %d: %d of %d frames", scene.name.c_str(),
                  NameOf(settings.sensor), name.c_str(), static_cast<int>(settings.seed),
                  run.tracked, run.frames);
      if (run.errors.ate.n > 0)
        std::printf(" from %d on, ATE %.2f cm", run.start, 100 * run.errors.ate.rmse);
      std::printf("\n");
      std::fflush(stdout);
    }
    known = variant.runs;
    return variant;
  }

  DynamicCase Modes(const DynamicScene& scene, const Boxes& detected, Sensor sensor) {
    DynamicCase of;
    of.of = CaseOf(scene, sensor);
    AddBoxes(scene, detected, of);
    for (const DynamicsMode mode : ModesToRun()) {
      of.variants.push_back(
          Run(NameOf(mode), scene, detected, With(sensor, mode), Pictures(scene, sensor, mode)));
    }
    return of;
  }

  void ComparePlain(const DynamicScene& plain, Sensor sensor, DynamicCase& of) {
    of.plain = Run("off, plain", plain, {}, With(sensor, DynamicsMode::kOff)).runs;
    for (DynamicVariant& variant : of.variants) {
      for (size_t i = 0; i < variant.runs.size(); ++i) {
        const Trajectory &here = variant.runs[i].trajectory, &alone = of.plain[i].trajectory;
        variant.ate_here.push_back(AteOf(plain.truth, Common(here, alone), sensor));
        variant.ate_plain.push_back(AteOf(plain.truth, Common(alone, here), sensor));
      }
    }
  }

  Table Ablation(const DynamicScene& scene, const Boxes& detected, Sensor sensor) {
    DynamicCase of;
    of.of = CaseOf(scene, sensor);
    of.of.name += ", ablation";
    AddBoxes(scene, detected, of);
    of.variants.push_back(Run("off", scene, detected, With(sensor, DynamicsMode::kOff)));
    SlamSettings settings = With(sensor, DynamicsMode::kFull);
    DynamicsSettings& dynamics = settings.dynamics;
    dynamics.geometry = dynamics.foreground = dynamics.propagate = dynamics.weigh = false;
    const auto add = [&](const char* name) {
      of.variants.push_back(Run(name, scene, detected, settings));
    };
    add("boxes only");
    dynamics.geometry = true;
    add("+ flow and epipolar");
    dynamics.foreground = true;
    add("+ foreground");
    dynamics.propagate = true;
    add("+ propagation");
    dynamics.weigh = true;
    add("+ belief weights = full");
    return VariantTable("ablation: what each part is worth", of);
  }

  Table Latency(const DynamicScene& scene, const Boxes& detected, Sensor sensor) {
    DynamicCase of;
    of.of = CaseOf(scene, sensor);
    of.of.name += ", detections";
    AddBoxes(scene, detected, of);
    SlamSettings settings = With(sensor, DynamicsMode::kFull);
    const int usual = settings.dynamics.detector_latency_frames;
    for (const int frames : {1, 3, 6, 10}) {
      settings.dynamics.detector_latency_frames = frames;
      of.variants.push_back(
          Run(std::to_string(frames) + " frames late", scene, detected, settings));
    }
    settings.dynamics.detector_latency_frames = usual;
    settings.dynamics.drop_detections = 0.3;
    of.variants.push_back(
        Run("30 % lost, " + std::to_string(usual) + " late", scene, detected, settings));
    return VariantTable("late and lost detections", of);
  }

  SlamSettings With(Sensor sensor, DynamicsMode mode) const {
    SlamSettings settings = settings_;
    settings.sensor = sensor;
    settings.dynamics.mode = mode;
    return settings;
  }

 private:
  std::vector<DynamicsMode> ModesToRun() const {
    std::vector<DynamicsMode> modes{DynamicsMode::kOff, DynamicsMode::kGeometry};
    if (detector_) modes.push_back(DynamicsMode::kFull);
    return modes;
  }

  // A few frames evenly spread, named after recording, sensor, mode and frame.
  FrameVisitor Pictures(const DynamicScene& scene, Sensor sensor, DynamicsMode mode) const {
    constexpr size_t kPictures = 4;
    if (options_.pictures.empty()) return nullptr;
    return [this, &scene, sensor, mode](size_t index, const Slam& slam) {
      const size_t count = scene.frames.size();
      bool wanted = false;
      for (size_t i = 0; i < kPictures; ++i)
        wanted |= index == (2 * i + 1) * count / (2 * kPictures);
      if (!wanted) return;
      std::string name = scene.name;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return c == ':' || c == '?' || c == '&'; }, '_');
      const SourceFrame& frame = scene.frames[index];
      const cv::Mat& image = frame.color.empty() ? frame.image : frame.color;
      WriteImage(options_.pictures + "/" + name + "_" + NameOf(sensor) + "_" +
                     std::to_string(frame.number) + "_" + NameOf(mode) + ".png",
                 DrawFeatures(image, slam.MoverMask(), slam.Features(), slam.camera().width));
    };
  }

  const DynamicOptions& options_;
  SlamSettings settings_;
  std::shared_ptr<Detector> detector_;
  std::map<std::string, std::vector<DynamicRun>> known_;  // by recording and settings
};

SlamSettings SettingsOf(const DynamicOptions& options) {
  RunOptions run;
  run.settings = options.settings;
  return SettingsFrom(run).slam;
}

}  // namespace

Section BenchDynamic(const DynamicOptions& options) {
  const std::vector<std::string> sources = SourcesOf(options);
  if (options.plain.size() > sources.size())
    ThrowUsage("--plain is given more often than there are recordings");
  if ((options.ablation || options.latency) && !options.detector)
    ThrowUsage("--ablation and --latency need --detector MODEL.onnx");
  const SlamSettings settings = SettingsOf(options);
  std::shared_ptr<Detector> network;
  std::shared_ptr<RememberingDetector> detector;
  if (options.detector) {
    network = OpenDetector(*options.detector, settings.dynamics.detector);
    detector = std::make_shared<RememberingDetector>(network);
  }
  if (!options.pictures.empty()) std::filesystem::create_directories(options.pictures);
  Study study(options, settings, detector);
  Section section;
  section.name = "dynamic";
  std::vector<DynamicCase> cases;
  std::vector<Table> others;
  for (size_t i = 0; i < sources.size(); ++i) {
    const bool rendered = IsSynthSource(sources[i]);
    const int count = options.frames > 0 ? options.frames : rendered ? kRenderedFrames : 0;
    const DynamicScene scene =
        LoadDynamicScene(sources[i], 0, count - 1, options.detector.has_value(), options.camera);
    std::optional<DynamicScene> plain;
    if (const auto part = PlainOf(options, sources[i], i)) {
      const int last = count > 0 ? part->first + count - 1 : part->last;
      plain = LoadDynamicScene(part->source, part->first, last, false, options.camera);
    }
    Boxes detected;
    if (detector && scene.has_masks())
      detected = DetectEverywhere(scene, settings.dynamics, *detector);
    for (const Sensor sensor : SensorsOf(options, scene.info.sensor)) {
      cases.push_back(study.Modes(scene, detected, sensor));
      if (plain) study.ComparePlain(*plain, sensor, cases.back());
      if (options.ablation) others.push_back(study.Ablation(scene, detected, sensor));
      if (options.latency) others.push_back(study.Latency(scene, detected, sensor));
      if (options.live) {
        others.push_back(BenchDynamicLive(scene, cases.back().of,
                                          study.With(sensor, DynamicsMode::kOff), network,
                                          section.u_milliseconds));
      }
    }
  }
  if (cases.empty()) ThrowUsage("--sensor: none of the recordings can be run like that");
  section.tables = ErrorTables(cases);
  for (Table table : {CoverageTable(cases), MaskTable(cases), PlainTable(cases)}) {
    if (!table.lines.empty()) section.tables.push_back(std::move(table));
  }
  section.tables.insert(section.tables.end(), others.begin(), others.end());
  section.tables.push_back(RunTable(cases));
  if (detector)
    section.timings.push_back({{"the network alone"}, detector->milliseconds(), "per frame"});
  return section;
}

}  // namespace alidade::bench
