#include "alidade/run/play/loop.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/timing.h"

namespace alidade {
namespace {

constexpr int kWarnedFrames = 10;  // warnings about individual frames at most
constexpr double kBlack = 10;      // mean grey level

std::atomic<int> g_interrupted{0};  // requests so far
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers may touch nothing else");

void Interrupt(int) {
  if (g_interrupted == 2) _exit(kInterruptedStatus);
  ++g_interrupted;
}

// Waits for the workers; a second signal aborts the wait.
class Finisher {
 public:
  explicit Finisher(Slam& slam)
      : thread_([this, &slam] {
          while (!done_ && g_interrupted < 2)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
          if (!done_) slam.CutFinishShort();
        }) {}
  ~Finisher() {
    done_ = true;
    thread_.join();
  }
  Finisher(const Finisher&) = delete;
  Finisher& operator=(const Finisher&) = delete;

 private:
  std::atomic<bool> done_{false};
  std::thread thread_;  // last, because it uses the other members
};

// Waits until a frame is due.
class Pacer {
 public:
  explicit Pacer(const Rate& rate) : rate_(rate) {}

  // Returns how late the frame is, seconds.
  double WaitFor(double frame_time) {
    if (rate_.kind == Rate::Kind::kMax || !std::isfinite(frame_time)) return 0;
    if (count_ == 0) {
      first_time_ = frame_time;
      clock_ = Stopwatch();
    }
    const double due =
        rate_.kind == Rate::Kind::kRealtime ? frame_time - first_time_ : count_ / rate_.fps;
    ++count_;
    // In steps, so that Ctrl-C takes effect soon.
    while (!Interrupted()) {
      const double left = due - clock_.Milliseconds() * 1e-3;
      if (left <= 0) return -left;
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left, 0.05)));
    }
    return 0;
  }

 private:
  Rate rate_;
  double first_time_ = 0;  // seconds
  Stopwatch clock_;
  int count_ = 0;  // frames so far
};

// CPU time since its construction, except for reading images.
class CpuMeter {
 public:
  explicit CpuMeter(const ReadAhead& source) : source_(source), start_(Now()) {}
  double Seconds() const { return Now() - start_; }

 private:
  double Now() const { return ProcessCpuSeconds() - source_.ReadCpuSeconds(); }
  const ReadAhead& source_;
  double start_;
};

void Drop(const SourceFrame& frame, const std::string& problem, RunRecord& record) {
  if (record.dropped == 0) record.first_problem = problem;
  if (++record.dropped <= kWarnedFrames) {
    LogWarning("frame " + std::to_string(frame.number) + " skipped: " + problem);
  }
}

// Warns once for each part; a failed detector warns itself.
void TellWhatStopped(const TrackResult& result, const Slam& slam, RunRecord& record) {
  if (result.warning.empty()) return;
  SlamHealth health = slam.Health();
  for (const StageHealth& stage : health.stages) {
    const auto told = std::find_if(record.health.stages.begin(), record.health.stages.end(),
                                   [&](const StageHealth& s) { return s.name == stage.name; });
    if (stage.running || stage.name == "detector") continue;
    if (told != record.health.stages.end() && !told->running) continue;
    LogWarning(stage.name + " stopped (" + stage.failure + "); the run continues without it");
  }
  record.health = std::move(health);
}

void Feed(const SourceFrame& frame, Slam& slam, const std::vector<RunWatcher*>& watchers,
          RunRecord& record, MaskWriter* masks) {
  ++record.frames;
  if (std::isfinite(frame.time)) {
    if (!record.first_time) record.first_time = frame.time;
    record.last_time = frame.time;
  }
  if (frame.T_world_camera) {
    record.truth.push_back({frame.time, *frame.T_world_camera, frame.stamp});
  }
  if (!frame.problem.empty()) {
    Drop(frame, frame.problem, record);
    return;
  }
  TrackResult result;
  const int counted = slam.frames();
  record.stamps.push_back(frame.stamp);
  record.numbers.push_back(frame.number);
  try {
    result = slam.Track(InputOf(frame));
  } catch (...) {
    const std::exception_ptr failure = std::current_exception();
    const std::string what = WhatOf(failure);
    if (slam.frames() == counted) {
      record.stamps.pop_back();
      record.numbers.pop_back();
      Drop(frame, what, record);
      return;
    }
    // The frame counts as one without a pose; the run continues.
    if (!record.bug) record.bug = failure;
    ++record.untracked_reasons[what];
    LogWarning("frame " + std::to_string(frame.number) + " failed: " + what);
    return;
  }
  TellWhatStopped(result, slam, record);
  if (masks) masks->Write(frame, slam.MoverMask());
  if (result.state != TrackState::kTracking) {
    ++record.untracked_reasons[result.reason()];
    record.untracked.Add(
        frame.time, result.reason(), frame.image,
        static_cast<double>(slam.Features().size()) / record.settings.tracker.extractor.features);
    record.dark += cv::mean(frame.image)[0] < kBlack;
  } else if (result.keyframe) {
    record.untracked.AddKeyFrame(frame.image);
    record.album.Add(static_cast<int>(record.stamps.size()) - 1, frame, slam);
  } else {
    record.untracked.Tracked();
  }
  for (RunWatcher* watcher : watchers) watcher->Frame(frame, result);
}

}  // namespace

void CatchInterrupts() {
  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);
}

void RequestInterrupt() {
  if (g_interrupted < 2) ++g_interrupted;
}

void ForgetInterrupts() { g_interrupted = 0; }

bool Interrupted() { return g_interrupted != 0; }

void RunFrames(ReadAhead& source, const Rate& rate, Slam& slam,
               const std::vector<RunWatcher*>& watchers, RunRecord& record, MaskWriter* masks) {
  Pacer pacer(rate);
  std::optional<CpuMeter> cpu;
  std::optional<Stopwatch> wall;
  const bool may_drop = record.settings.threaded;  // the inline schedule must be reproducible
  try {
    while (!Interrupted()) {
      const std::optional<SourceFrame> frame = source.Next();
      if (!frame) break;
      if (!cpu) {
        cpu.emplace(source);
        wall.emplace();
      }
      for (RunWatcher* watcher : watchers) watcher->Wait(Interrupted);
      const double late = pacer.WaitFor(frame->time);
      if (may_drop && late > record.settings.time.max_latency && source.ready()) {
        ++record.late;
        continue;
      }
      Feed(*frame, slam, watchers, record, masks);
    }
  } catch (...) {  // any exception: the results so far are written
    record.failure = std::current_exception();
  }
  for (RunWatcher* watcher : watchers) watcher->Finishing();
  {
    const Finisher finisher(slam);
    slam.Finish();
  }
  record.health = slam.Health();
  if (cpu) record.cpu_s = cpu->Seconds();
  if (wall) record.wall_s = wall->Milliseconds() * 1e-3;
  record.interrupted = Interrupted();
  if (record.dropped > kWarnedFrames) {
    LogWarning(std::to_string(record.dropped) + " frames were skipped in total");
  }
}

std::string WhyNothing(const RunRecord& record) {
  if (record.frames == 0) return "the source has no frame";
  if (record.dropped == record.frames) {
    return "none of the " + std::to_string(record.frames) + " frames could be used (" +
           record.first_problem + ")";
  }
  const int used = record.frames - record.dropped;
  if (2 * record.dark > used) return "the images are black";
  const auto most =
      std::max_element(record.untracked_reasons.begin(), record.untracked_reasons.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == record.untracked_reasons.end() ? "no frame was tracked" : most->first;
}

}  // namespace alidade
