#include "bench/phone/phone.h"

#include <array>
#include <limits>

#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/run/sources/truth.h"
#include "bench/measure/reference.h"
#include "bench/parts/parts.h"
#include "program/terminal.h"

namespace alidade::bench {
namespace {

constexpr double kUntold = std::numeric_limits<double>::quiet_NaN();

SlamSettings PhoneSettingsFor(const std::string& profile) {
  SlamSettings settings;
  settings.sensor = Sensor::kMono;
  settings.ApplyProfile(profile);
  return settings;
}

// From all of the picture to the phone profile, one change at a time.
std::vector<PhoneVariant> PhoneSteps() {
  std::vector<PhoneVariant> steps = {
      {"full size, 1000 features", PhoneSettingsFor("desktop"), 1, "desktop"}};
  const SlamSettings phone = PhoneSettingsFor("phone");
  steps.push_back({"400 pixels wide", steps.back().settings});
  steps.back().settings.image_width = phone.image_width;
  steps.push_back({"and 500 features", steps.back().settings});
  steps.back().settings.tracker.extractor.features = phone.tracker.extractor.features;
  steps.push_back({"and thresholds x 0.8: phone profile", phone, 1, "phone"});
  return steps;
}

// The first and the last of the steps, with threads.
std::vector<PhoneVariant> WithThreads(const std::vector<PhoneVariant>& steps) {
  std::vector<PhoneVariant> variants;
  for (const PhoneVariant& step : {steps.front(), steps.back()}) {
    const std::string name = step.settings.image_width == 0 ? "full size" : "phone profile";
    SetThreadCount(0);
    if (ThreadCount() > 1)
      variants.push_back({name + ", loops on " + std::to_string(ThreadCount()) + " threads",
                          step.settings, 0, step.profile});
    variants.push_back({name + ", stages on threads, live", step.settings, 0, step.profile});
    variants.back().settings.threaded = true;
  }
  return variants;
}

struct PhoneJudged {
  double ate_cm = kUntold;
  double coverage = 0;  // per cent of the frames that have a pose in the largest map
};

PhoneJudged JudgePhone(const PhoneRecording& recording, const PhoneRun& run) {
  PhoneJudged judged;
  const std::vector<SourceFrame>& frames = recording.recording.frames;
  judged.coverage =
      100 * static_cast<double>(run.trajectory.size()) / static_cast<double>(frames.size());
  if (recording.truth.empty()) return judged;
  std::string problem;
  const auto errors = ErrorsAgainst(recording.truth, run.trajectory, true,
                                    TimeSpan{frames.front().time, frames.back().time}, &problem);
  if (errors) judged.ate_cm = 100 * errors->ate.error.rmse;
  return judged;
}

double MedianMilliseconds(const std::vector<double>& milliseconds) {
  return milliseconds.empty() ? kUntold : Summarise(milliseconds).median;
}

// `profile`: of the settings it was run with.
void AddPhoneRow(const std::string& name, const std::string& profile,
                 const PhoneRecording& recording, const PhoneRun& run, Table& table) {
  const PhoneJudged judged = JudgePhone(recording, run);
  const Summary frame = Summarise(run.frame);
  const Recording& of = recording.recording;
  Case each{ShortName(of.source) + ", " + name, "mono", profile, of.source, name};
  each.frames = static_cast<int>(of.frames.size());
  table.lines.push_back({std::move(each),
                         {MedianMilliseconds(run.extract), MedianMilliseconds(run.track),
                          MedianMilliseconds(run.map), frame.median, frame.mean, run.cpu,
                          judged.ate_cm, judged.coverage, static_cast<double>(run.keyframes)}});
}

// Turns of the reference before and after each run: how fast the machine was meanwhile.
void TakeReference(const PhoneRecording& recording, std::vector<double>& u) {
  constexpr size_t kReferenceTurns = 10;
  Reference reference;
  for (size_t i = 0; i < kReferenceTurns; ++i)
    u.push_back(
        reference.Run(recording.recording.frames[i % recording.recording.frames.size()].image));
}

// Milliseconds of a whole frame as they came down, as the paper tells it. Its figures are those of
// its text, on its phone of 2017 or so.
Table WholeFrame(const std::string& source, const std::array<double, 3>& native,
                 const std::array<double, 3>& wasm) {
  constexpr std::array<double, 3> kPaper = {1134, 513, 175};
  Table table{"whole frame, mean, and times as fast as before all",
              {{"native", "ms"},
               {"native_speedup"},
               {"wasm", "ms"},
               {"wasm_speedup"},
               {"paper", "ms"},
               {"paper_speedup"}}};
  const std::array<std::string, 3> names = {"before", "after the parameters", "and with threads"};
  for (size_t i = 0; i < names.size(); ++i) {
    table.lines.push_back(
        {{ShortName(source) + ", whole frame, " + names[i], "mono", "", source, names[i]},
         {native[i], native[0] / native[i], wasm[i], wasm[0] / wasm[i], kPaper[i],
          kPaper[0] / kPaper[i]}});
  }
  table.note =
      "With threads: Track() of the threaded schedule at the recording's rate, mapping beside it. "
      "paper: from its text; another system, on its own phone.";
  return table;
}

}  // namespace

std::vector<Section> BenchPhone(const std::string& source, int frames) {
  const PhoneRecording recording = LoadPhoneRecording(source, frames > 0 ? frames : 600);
  Terminal terminal(false);
  Section section;
  section.name = "phone " + source;
  Table table{"median of each part (map: per keyframe), of a whole frame, and its mean",
              {{"extract", "ms"},
               {"track", "ms"},
               {"map", "ms"},
               {"frame", "ms"},
               {"frame_mean", "ms"},
               {"cpu", "ms"},
               {"ate_rmse", "cm"},
               {"coverage", "%"},
               {"keyframes"}}};
  std::array<double, 3> native{kUntold, kUntold, kUntold}, wasm = native;
  const std::vector<PhoneVariant> steps = PhoneSteps();
  const auto run = [&](const PhoneVariant& variant, const std::string& name) {
    terminal.SetProgress("phone: " + name);
    TakeReference(recording, section.u_milliseconds);
    const PhoneRun done = RunNative(recording, variant);
    TakeReference(recording, section.u_milliseconds);
    AddPhoneRow(name, variant.profile, recording, done, table);
    return Summarise(done.frame).mean;
  };
  for (const PhoneVariant& step : steps) {
    const double mean = run(step, step.name);
    if (&step == &steps.front()) native[0] = mean;
    if (&step == &steps.back()) native[1] = mean;
  }
  for (const PhoneVariant& variant : WithThreads(steps)) native[2] = run(variant, variant.name);

  std::string problem;
  for (const PhoneVariant* step : {&steps.front(), &steps.back()}) {
    terminal.SetProgress("phone: WebAssembly, " + step->name);
    const auto done = RunWasm(recording, step->settings, &problem);
    if (!done) break;
    AddPhoneRow("WASM, " + std::string(step == &steps.front() ? "full size" : "phone profile"),
                step->profile, recording, *done, table);
    wasm[step == &steps.front() ? 0 : 1] = Summarise(done->frame).mean;
  }
  terminal.SetProgress("");
  table.note =
      "One thread and the inline schedule where nothing else is said. coverage: frames with a "
      "pose in the largest map, at the end. cpu: mean of all threads per frame. ";
  table.note += recording.truth.empty() ? "No truth is known of this recording. " : "";
  table.note += problem.empty() ? "WASM: Node.js, one thread." : "WASM was left out: " + problem;
  section.tables.push_back(std::move(table));
  section.tables.push_back(WholeFrame(source, native, wasm));
  SetThreadCount(0);
  Section ransac = BenchRansac(recording.recording);
  ransac.name += " " + source;
  for (Timing& timing : ransac.timings) timing.of.name = ShortName(source) + ", " + timing.of.name;
  return {std::move(section), std::move(ransac)};
}

}  // namespace alidade::bench
