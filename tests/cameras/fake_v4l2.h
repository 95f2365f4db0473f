// Cameras of a kernel that this machine does not have: open(), ioctl(), mmap() and close() of
// /dev/videoN are answered here, as Video4Linux's documentation says drivers answer. Everything
// else goes to the C library. In a test program, or preloaded into another one
// (fake_v4l2_preload.cc).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace alidade {

struct FakeMode {
  uint32_t code = 0;  // V4L2_PIX_FMT_…
  int width = 0, height = 0;
  std::vector<double> rates;  // images per second
};

struct FakeControl {
  int least = 0, most = 0, value = 0;
};

// A camera. Its thread-safe state is changed by the program that opens it.
struct FakeCamera {
  std::string name, bus;
  std::vector<FakeMode> modes;
  std::map<uint32_t, FakeControl> controls;
  // The bytes of image `i` in a format; images come at the rate that was set.
  std::function<std::string(size_t i, uint32_t code)> picture;
  uint32_t stride = 0;  // bytes from row to row; 0: no gaps
  bool monotonic = true;
  size_t damaged = SIZE_MAX;     // index of an image that arrives damaged
  size_t gone_after = SIZE_MAX;  // images until it is unplugged
  int opened = 0;                // how often it was opened
  bool streams = false;
};

// Cameras that are plugged in, by their numbers. Guarded by the mutex.
struct FakeBus {
  std::mutex mutex;
  std::map<int, std::shared_ptr<FakeCamera>> cameras;
  std::map<int, int> errors;  // errno that open() gives, by number
};
FakeBus& TheFakeBus();

void Plug(int number, std::shared_ptr<FakeCamera> camera);
void UnplugAll();

}  // namespace alidade
