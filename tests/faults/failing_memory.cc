#include "faults/failing_memory.h"

#include <atomic>
#include <cstdlib>
#include <new>
#include <opencv2/core.hpp>

namespace alidade {
namespace {

std::atomic<long> g_count{0}, g_first{-1}, g_last{-1}, g_failed{0};

bool Fails() {
  const long number = g_count.fetch_add(1, std::memory_order_relaxed);
  if (number < g_first.load(std::memory_order_relaxed) ||
      number >= g_last.load(std::memory_order_relaxed))
    return false;
  g_failed.fetch_add(1, std::memory_order_relaxed);
  return true;
}

void* Allocate(std::size_t size, std::size_t alignment) noexcept {
  if (Fails()) return nullptr;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(size > 0 ? size : 1);
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* AllocateOrThrow(std::size_t size, std::size_t alignment) {
  void* memory = Allocate(size, alignment);
  if (!memory) throw std::bad_alloc();
  return memory;
}

// Images: OpenCV has an allocator of its own.
class FailingImages : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    if (Fails()) CV_Error(cv::Error::StsNoMem, "no memory for an image");
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override {
    cv::Mat::getStdAllocator()->deallocate(data);
  }
};

}  // namespace

void FailAllocations(long after, long failures) {
  static FailingImages images;
  cv::Mat::setDefaultAllocator(&images);
  g_failed = 0;
  g_first = -1;
  g_last = g_count + after + failures;
  g_first = g_count + after;
}

long StopFailing() {
  g_first = g_last = -1;
  return g_failed;
}

long AllocationCount() { return g_count; }

}  // namespace alidade

using alidade::Allocate;
using alidade::AllocateOrThrow;
constexpr std::size_t kPlain = alignof(std::max_align_t);
void* operator new(std::size_t size) { return AllocateOrThrow(size, kPlain); }
void* operator new[](std::size_t size) { return AllocateOrThrow(size, kPlain); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return AllocateOrThrow(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return AllocateOrThrow(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return Allocate(size, kPlain);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return Allocate(size, kPlain);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
