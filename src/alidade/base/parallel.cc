#include "alidade/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace alidade {
namespace {

struct Loop {
  const std::function<void(int)>* body;
  int count;
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;

  void Work() {
    for (int i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
      try {
        (*body)(i);
      } catch (...) {
        std::lock_guard<std::mutex> lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  }
};

// Workers sleep between loops. One loop at a time has them; `loop_` is null in between.
class Pool {
 public:
  ~Pool() { Stop(); }

  bool TryRun(Loop& loop, int threads) {
    std::unique_lock<std::mutex> owner(owner_, std::try_to_lock);
    if (!owner.owns_lock()) return false;
    if (static_cast<int>(workers_.size()) != threads - 1) {
      Stop();
      Start(threads - 1);
    }
    {
      std::lock_guard<std::mutex> lock(mutex_);
      loop_ = &loop;
      ++generation_;
      busy_ = static_cast<int>(workers_.size());
    }
    wake_.notify_all();
    loop.Work();
    std::unique_lock<std::mutex> lock(mutex_);
    done_.wait(lock, [&] { return busy_ == 0; });
    loop_ = nullptr;
    return true;
  }

 private:
  void Start(int count) {
    stopping_ = false;
    const uint64_t generation = generation_;
    for (int i = 0; i < count; ++i) workers_.emplace_back([this, generation] { Run(generation); });
  }

  void Stop() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    for (std::thread& worker : workers_) worker.join();
    workers_.clear();
  }

  void Run(uint64_t seen);

  std::mutex owner_, mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> workers_;
  Loop* loop_ = nullptr;
  uint64_t generation_ = 0;
  int busy_ = 0;
  bool stopping_ = false;
};

std::atomic<int> g_threads{0};
thread_local bool t_inside_loop = false;

void Pool::Run(uint64_t seen) {
  t_inside_loop = true;
  while (true) {
    Loop* loop;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [&] { return stopping_ || generation_ != seen; });
      if (stopping_) return;
      seen = generation_;
      loop = loop_;
    }
    loop->Work();
    std::lock_guard<std::mutex> lock(mutex_);
    if (--busy_ == 0) done_.notify_one();
  }
}

Pool& ThePool() {
  static Pool pool;
  return pool;
}

}  // namespace

void SetThreadCount(int threads) { g_threads = std::max(0, threads); }

int ThreadCount() {
  const int set = g_threads;
  return set > 0 ? set : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void ParallelFor(int count, const std::function<void(int)>& body) {
  if (count <= 0) return;
  Loop loop;
  loop.body = &body;
  loop.count = count;
  const int threads = ThreadCount();
  bool ran = false;
  if (threads > 1 && count > 1 && !t_inside_loop) {
    t_inside_loop = true;
    ran = ThePool().TryRun(loop, threads);
    t_inside_loop = false;
  }
  if (!ran) loop.Work();
  if (loop.failure) std::rethrow_exception(loop.failure);
}

}  // namespace alidade
