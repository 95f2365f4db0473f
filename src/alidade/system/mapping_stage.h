// The mapper on its own thread, or inline: same worker, two schedules.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "alidade/mapping/mapper.h"

namespace alidade {

class MappingStage {
 public:
  MappingStage(Mapper& mapper, bool threaded);
  ~MappingStage();  // drops what is queued

  void Add(KeyFrameId
               id);  // inline: done on return. Threaded: queued; a running adjustment is cut short
  int backlog() const;  // keyframes waiting or in work
  void Drain();         // returns when nothing is waiting or in work; throws what the worker threw
  std::vector<double> Milliseconds() const;  // one per keyframe done

 private:
  void Run();
  void Process(KeyFrameId id);

  Mapper& mapper_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<KeyFrameId> queue_;
  bool working_ = false, stopping_ = false;
  std::atomic<bool> hurry_{false};
  std::exception_ptr failure_;
  std::vector<double> milliseconds_;
  std::thread thread_;
};

}  // namespace alidade
