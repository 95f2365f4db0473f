// Preloaded into the program: the ALIDADE_FAIL_ALLOCATION-th operator new of the threads that are
// not the main one throws. Once.
#include <atomic>
#include <cstdlib>
#include <new>
#include <thread>

namespace {

const std::thread::id g_main = std::this_thread::get_id();

long CountDown() {
  const char* number = std::getenv("ALIDADE_FAIL_ALLOCATION");
  return number ? std::atol(number) : -1;
}
std::atomic<long> g_left{CountDown()};

}  // namespace

void* operator new(std::size_t size) {
  if (std::this_thread::get_id() != g_main && g_left.fetch_sub(1) == 1) throw std::bad_alloc();
  if (void* bytes = std::malloc(size > 0 ? size : 1)) return bytes;
  throw std::bad_alloc();
}
void operator delete(void* bytes) noexcept { std::free(bytes); }
void operator delete(void* bytes, std::size_t) noexcept { std::free(bytes); }
