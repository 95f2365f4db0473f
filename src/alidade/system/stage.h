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

namespace alidade {

enum class Schedule {
  kInline,      // done before Add() returns
  kThread,      // queued for a thread that shares the loops' workers
  kBackground,  // queued for a thread that keeps to itself and gives way to the others
};

class Stage {
 public:
  // `stop` turns true when something else is waiting: long work should come to an end. Null inline.
  using Work = std::function<void(KeyFrameId id, const std::atomic<bool>* stop)>;
  Stage(Work work, Schedule schedule);
  ~Stage();
  void Stop();  // drops what is queued, and returns when nothing is in work

  void Add(KeyFrameId id);
  int backlog() const;  // keyframes waiting or in work
  void GiveUp();        // drops what is queued, and hurries what is in work; goes on afterwards
  void Drain();         // returns when nothing is waiting or in work; throws what the work threw
  std::vector<double> Milliseconds() const;  // one per keyframe done

  // Runs `action` while this stage rests: what is in work is hurried to its end, what waits, waits.
  void WhileResting(const std::function<void()>& action);

 private:
  void Run();
  void Process(KeyFrameId id);

  Work work_;
  Schedule schedule_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<KeyFrameId> queue_;
  bool working_ = false, stopping_ = false;
  int rests_ = 0;  // actions that are waiting or running
  std::atomic<bool> hurry_{false};
  std::exception_ptr failure_;
  std::vector<double> milliseconds_;
  std::thread thread_;
};

}  // namespace alidade
