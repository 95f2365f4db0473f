// A worker that processes keyframes one after another, on its own thread or inline.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "alidade/base/ids.h"
#include "alidade/base/timing.h"

namespace alidade {

enum class Schedule {
  kInline,      // processed before Add() returns
  kThread,      // queued for a thread that uses the threads of parallel loops (base/parallel.h)
  kBackground,  // queued for a thread of lower priority that runs its loops alone
};

// An exception thrown by the work ends the stage, in all schedules: it drops its queue and does
// nothing from then on. failure() returns the exception; it is not rethrown.
class Stage {
 public:
  // `stop` becomes true when other work is waiting: long work should end early then. Null inline.
  using Work = std::function<void(KeyFrameId id, const std::atomic<bool>* stop)>;
  Stage(Work work, Schedule schedule);
  ~Stage();
  void Stop();  // drops the queue, ends the thread, and returns when no work is in progress

  void Add(KeyFrameId id) noexcept;
  // Queues a function behind the keyframes added so far, to run in the stage's thread (inline: at
  // once). False if the stage has failed or stopped: then it does not run.
  bool AddErrand(std::function<void()> errand) noexcept;
  int backlog() const;  // keyframes and errands that are queued or in progress
  // Drops the queued keyframes and makes work in progress end early. The stage accepts new
  // keyframes afterwards.
  void GiveUp();
  void Drain();  // returns when nothing is queued or in progress
  const SampleLog& milliseconds() const { return milliseconds_; }  // one per processed keyframe

  // Runs `action` in the caller's thread while this stage does no work: work in progress is made to
  // end early, queued work stays queued. Rethrows what `action` throws.
  void WhileResting(const std::function<void()>& action);

  std::exception_ptr failure() const;  // what ended the stage; null: it has not failed
  // Runs `action` in the caller's thread as work of this stage: an exception ends the stage. Does
  // nothing if the stage has failed.
  template <typename Action>
  void Guard(Action&& action) noexcept {
    if (failure()) return;
    try {
      action();
    } catch (...) {
      Fail(std::current_exception());
    }
  }

 private:
  struct Task {
    KeyFrameId id;
    std::function<void()> errand;  // if set, run instead of the work
  };
  void Run();
  bool Enqueue(Task task) noexcept;
  void Process(Task& task) noexcept;
  void Fail(const std::exception_ptr& what) noexcept;

  Work work_;
  Schedule schedule_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> queue_;
  bool working_ = false, stopping_ = false;
  int rests_ = 0;                   // calls of WhileResting() that wait or run
  std::atomic<bool> hurry_{false};  // `stop` of the work
  std::exception_ptr failure_;
  SampleLog milliseconds_;
  std::thread thread_;
};

}  // namespace alidade
