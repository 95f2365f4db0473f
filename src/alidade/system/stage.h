// A worker that keyframes are handed to, on its own thread or inline: same worker, two schedules.
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
  kInline,      // done before Add() returns
  kThread,      // queued for a thread that shares the loops' workers
  kBackground,  // queued for a thread that keeps to itself and gives way to the others
};

// What the work throws ends it: the stage has failed, drops what is queued, and from then on does
// nothing, in both schedules. failure() keeps it; it is not thrown again.
class Stage {
 public:
  // `stop` turns true when something else is waiting: long work should come to an end. Null inline.
  using Work = std::function<void(KeyFrameId id, const std::atomic<bool>* stop)>;
  Stage(Work work, Schedule schedule);
  ~Stage();
  void Stop();  // drops what is queued, and returns when nothing is in work

  void Add(KeyFrameId id) noexcept;
  // To be run in turn by whoever does the work: nobody waits for it. False when the stage has
  // failed: then it is not run.
  bool AddErrand(std::function<void()> errand) noexcept;
  int backlog() const;  // keyframes and errands waiting or in work
  // Drops the keyframes that are queued, and hurries what is in work; goes on afterwards.
  void GiveUp();
  void Drain();  // returns when nothing is waiting or in work
  const SampleLog& milliseconds() const { return milliseconds_; }  // one per keyframe done

  // Runs `action` while this stage rests: what is in work is hurried to its end, what waits, waits.
  // What it throws comes out here.
  void WhileResting(const std::function<void()>& action);

  std::exception_ptr failure() const;  // null: none
  // Runs what the caller does for this stage: what it throws is the stage's failure. Not run once
  // there is one.
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
    std::function<void()> errand;  // instead of the work, when there is one
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
  int rests_ = 0;  // actions that are waiting or running
  std::atomic<bool> hurry_{false};
  std::exception_ptr failure_;
  SampleLog milliseconds_;
  std::thread thread_;
};

}  // namespace alidade
