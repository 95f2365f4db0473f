#include "alidade/base/parallel.h"

#ifdef __linux__
#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <system_error>
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

// Workers sleep between loops; spinning saved no time and cost CPU time. One loop at a time uses
// them; `loop_` is null between loops. A worker that wakes joins the loop if it is still running.
// The caller waits only for workers inside the loop, not for sleeping ones.
class Pool {
 public:
  ~Pool() { Stop(); }

  bool TryRun(Loop& loop, int threads) {
    std::unique_lock<std::mutex> owner(owner_, std::try_to_lock);
    if (!owner.owns_lock()) return false;
    if (threads_ != threads) {
      Stop();
      Start(threads);
    }
    {
      std::lock_guard<std::mutex> lock(mutex_);
      loop_ = &loop;
      ++generation_;
    }
    const int helpers = std::min(static_cast<int>(workers_.size()), loop.count - 1);
    for (int i = 0; i < helpers; ++i) wake_.notify_one();
    loop.Work();
    std::unique_lock<std::mutex> lock(mutex_);
    loop_ = nullptr;  // no worker can join from here on
    done_.wait(lock, [&] { return active_ == 0; });
    return true;
  }

 private:
  void Start(int threads) {
    threads_ = threads;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = false;
    }
    try {
      for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { Run(); });
    } catch (const std::system_error&) {
      // The system has no more threads: continue with those that exist.
    } catch (const std::bad_alloc&) {
      // Out of memory: likewise.
    }
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

  void Run();

  std::mutex owner_;  // held by the caller whose loop is running
  int threads_ = 1;
  std::vector<std::thread> workers_;

  std::mutex mutex_;  // guards all members below
  std::condition_variable wake_, done_;
  Loop* loop_ = nullptr;
  uint64_t generation_ = 0;
  int active_ = 0;  // workers inside the loop
  bool stopping_ = false;
};

std::atomic<int> g_threads{0};
thread_local bool t_inside_loop = false;  // or set by KeepLoopsOnThisThread()

void Pool::Run() {
  t_inside_loop = true;
  uint64_t seen =
      0;  // generations start at 1; a loop that has ended is recognized by loop_ == nullptr
  while (true) {
    Loop* loop;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [&] { return stopping_ || generation_ != seen; });
      if (stopping_) return;
      seen = generation_;
      loop = loop_;
      if (loop == nullptr) continue;
      ++active_;
    }
    loop->Work();
    std::lock_guard<std::mutex> lock(mutex_);
    if (--active_ == 0) done_.notify_one();
  }
}

std::unique_ptr<Pool>& PoolOfProcess() {
  static auto pool = std::make_unique<Pool>();
  return pool;
}

Pool& ThePool() {
#ifdef __linux__
  // A forked process has no copy of the threads. It gets a pool of its own and never destroys the
  // other one, which would wait for them.
  [[maybe_unused]] static const int registered = [] {
    PoolOfProcess();  // before the first fork
    return pthread_atfork(nullptr, nullptr, [] {
      static_cast<void>(PoolOfProcess().release());
      PoolOfProcess() = std::make_unique<Pool>();
    });
  }();
#endif
  return *PoolOfProcess();
}

}  // namespace

void SetThreadCount(int threads) { g_threads = std::max(0, threads); }

int ThreadCount() {
  const int set = g_threads;
  return set > 0 ? set : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void KeepLoopsOnThisThread() { t_inside_loop = true; }

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

void LowerThreadPriority() {
#ifdef __linux__
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 5);
#endif
}

}  // namespace alidade
