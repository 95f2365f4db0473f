#include "alidade/run/play/loop.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/timing.h"
#include "alidade/run/sources/frame_input.h"

namespace alidade {
namespace {

constexpr int kWarnedFrames = 10;   // warnings about individual frames at most
constexpr double kBlack = 10;       // mean grey level
constexpr double kLookedUp = 0.05;  // seconds from Ctrl-C to its effect while no image comes

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

// False when interrupted: a live source may have no image for long.
bool WaitForFrame(const ReadAhead& source) {
  while (!Interrupted()) {
    if (source.Wait(kLookedUp)) return true;
  }
  return false;
}

void Drop(const SourceFrame& frame, const std::string& problem, RunLog& log) {
  if (log.dropped == 0) log.first_problem = problem;
  if (++log.dropped <= kWarnedFrames) {
    LogWarning("frame " + std::to_string(frame.number) + " skipped: " + problem);
  }
}

// Once for each part; a detector that fails says so itself.
void TellWhatStopped(const TrackResult& result, const Slam& slam, RunLog& log) {
  if (result.warning.empty()) return;
  SlamHealth health = slam.Health();
  for (const StageHealth& stage : health.stages) {
    const auto told = std::find_if(log.health.stages.begin(), log.health.stages.end(),
                                   [&](const StageHealth& s) { return s.name == stage.name; });
    if (stage.running || stage.name == "detector") continue;
    if (told != log.health.stages.end() && !told->running) continue;
    LogWarning(stage.name + " stopped (" + stage.failure + "); going on without it");
  }
  log.health = std::move(health);
}

// `imu`: readings that were not given to `slam` yet; empty afterwards if they were.
void Feed(const SourceFrame& frame, std::vector<ImuSample>& imu, const SlamSettings& settings,
          Slam& slam, const std::vector<RunWatcher*>& watchers, RunLog& log, MaskWriter* masks) {
  ++log.frames;
  if (std::isfinite(frame.time)) {
    if (!log.first_time) log.first_time = frame.time;
    log.last_time = frame.time;
  }
  if (frame.T_world_camera) {
    log.truth.push_back({frame.time, *frame.T_world_camera, frame.stamp});
  }
  if (!frame.problem.empty()) {
    Drop(frame, frame.problem, log);
    return;
  }
  if (!frame.incomplete.empty() && ++log.incomplete <= kWarnedFrames)
    LogWarning("frame " + std::to_string(frame.number) + ": " + frame.incomplete);
  TrackResult result;
  const int counted = slam.frames();
  log.stamps.Add({frame.stamp, frame.number});
  try {
    FrameInput input = InputOf(frame);
    input.imu = imu;
    result = slam.Track(input);
    imu.clear();
  } catch (...) {
    const std::exception_ptr failure = std::current_exception();
    const std::string what = WhatOf(failure);
    if (slam.frames() == counted) {
      log.stamps.TakeBack();
      Drop(frame, what, log);
      return;
    }
    imu.clear();
    // The frame counts, without a pose; the next will do better.
    if (!log.bug) log.bug = failure;
    ++log.untracked_reasons[what];
    LogWarning("frame " + std::to_string(frame.number) + " failed: " + what);
    return;
  }
  TellWhatStopped(result, slam, log);
  if (masks) masks->Write(frame, slam.MoverMask());
  if (result.state != TrackState::kTracking) {
    ++log.untracked_reasons[result.reason()];
    log.untracked.Add(
        frame.time, result.reason(), frame.image,
        static_cast<double>(slam.Features().size()) / settings.tracker.extractor.features);
    log.dark += cv::mean(frame.image)[0] < kBlack;
  } else if (result.keyframe) {
    log.untracked.AddKeyFrame(frame.image);
    log.album.Add(static_cast<int>(log.stamps.size()) - 1, frame, slam);
  } else {
    log.untracked.Tracked();
  }
  for (RunWatcher* watcher : watchers) watcher->Frame(frame, result);
}

void Obey(const std::vector<RunWatcher*>& watchers, const SlamSettings& settings, Slam& slam) {
  for (RunWatcher* watcher : watchers) {
    const RunRequest request = watcher->Asked();
    if (request.mapping && !settings.localize) slam.SetMapping(*request.mapping);
    if (request.forget && settings.localize) slam.Reset();
    if (request.forget && !settings.localize) slam.Forget();
  }
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

void RunFrames(ReadAhead& source, const Rate& rate, const SlamSettings& settings, Slam& slam,
               const std::vector<RunWatcher*>& watchers, RunLog& log, MaskWriter* masks) {
  Pacer pacer(rate);
  std::optional<CpuMeter> cpu;
  std::optional<Stopwatch> wall;
  std::optional<int> part;     // of the frame before
  std::vector<ImuSample> imu;  // readings of skipped frames go to the next one
  const bool with_imu = slam.Inertial().given;
  const bool may_drop = settings.threaded;  // the inline schedule gives the same every time
  try {
    while (WaitForFrame(source)) {
      const std::optional<SourceFrame> frame = source.Next();
      if (!frame) break;
      if (!cpu) {
        cpu.emplace(source);
        wall.emplace();
      }
      for (RunWatcher* watcher : watchers) watcher->Wait(Interrupted);
      if (frame->part != part.value_or(frame->part)) imu.clear();
      if (with_imu) imu.insert(imu.end(), frame->imu.begin(), frame->imu.end());
      const double late = pacer.WaitFor(frame->time);
      if (may_drop && late > settings.time.max_latency && source.ready()) {
        ++log.late;
        continue;
      }
      if (frame->part != std::exchange(part, frame->part).value_or(frame->part)) slam.Reset();
      Obey(watchers, settings, slam);
      Feed(*frame, imu, settings, slam, watchers, log, masks);
    }
  } catch (...) {  // whatever it was: what was done until then is kept
    log.failure = std::current_exception();
  }
  for (RunWatcher* watcher : watchers) watcher->Finishing();
  {
    const Finisher finisher(slam);
    try {
      slam.Finish();
    } catch (const std::bad_alloc&) {  // no memory for the trajectory, or it cannot be read: the
    } catch (const Error&) {           // results ask for it again
    }
  }
  log.health = slam.Health();
  if (cpu) log.cpu_s = cpu->Seconds();
  log.late += source.replaced();
  if (wall) log.wall_s = wall->Milliseconds() * 1e-3;
  log.interrupted = Interrupted();
  if (log.dropped > kWarnedFrames)
    LogWarning(std::to_string(log.dropped) + " frames were skipped in total");
  if (log.incomplete > kWarnedFrames) {
    LogWarning(std::to_string(log.incomplete) +
               " frames had a depth or right image that could not be read");
  }
}

}  // namespace alidade
