#include "cameras/fake_v4l2.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <deque>
#include <optional>

namespace alidade {
namespace {

struct Buffer {
  char* memory = nullptr;
  size_t size = 0;
};

// An open device file: the file is a timer that expires with each image.
struct Opened {
  int number = 0;
  std::shared_ptr<FakeCamera> camera;
  FakeMode mode;
  double fps = 30;
  std::vector<Buffer> buffers;
  std::deque<uint32_t> queued;
  double start = 0;  // of the stream, monotonic seconds
  size_t next = 0;   // image
};

struct State {
  FakeBus bus;
  std::map<int, Opened> opened;  // by file; guarded by the bus's mutex
};
State& TheState() {
  static State* state = new State;  // never destroyed: programs close files at their very end
  return *state;
}

double Monotonic() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

bool IsGone(const Opened& file) {
  const auto now = TheState().bus.cameras.find(file.number);
  return now == TheState().bus.cameras.end() || now->second != file.camera;
}

template <typename Text, size_t N>
void Copy(Text (&to)[N], const std::string& from) {
  std::memset(to, 0, N);
  std::memcpy(to, from.data(), std::min(from.size(), N - 1));
}

std::vector<uint32_t> CodesOf(const FakeCamera& camera) {
  std::vector<uint32_t> codes;
  for (const FakeMode& mode : camera.modes) {
    if (std::find(codes.begin(), codes.end(), mode.code) == codes.end()) codes.push_back(mode.code);
  }
  return codes;
}

v4l2_fract IntervalOf(double fps) { return {1000, static_cast<uint32_t>(std::lround(1000 * fps))}; }

size_t BytesOf(const Opened& file) {
  const size_t row =
      file.camera->stride > 0 ? file.camera->stride : 2 * static_cast<size_t>(file.mode.width);
  return row * static_cast<size_t>(file.mode.height) * 3 / 2;
}

void SetTimer(int fd, double fps) {
  itimerspec timer{};
  if (fps > 0) {
    const auto nanoseconds = static_cast<long>(1e9 / fps);
    timer.it_value = timer.it_interval = {nanoseconds / 1000000000, nanoseconds % 1000000000};
  }
  timerfd_settime(fd, 0, &timer, nullptr);
}

int SetFormat(Opened& file, v4l2_format& format) {
  if (file.camera->streams) return EBUSY;
  const FakeMode* best = nullptr;
  long nearest = 0;
  for (const FakeMode& mode : file.camera->modes) {
    if (mode.code != format.fmt.pix.pixelformat) continue;
    const long away = std::labs(mode.width - static_cast<long>(format.fmt.pix.width)) +
                      std::labs(mode.height - static_cast<long>(format.fmt.pix.height));
    if (!best || away < nearest) best = &mode, nearest = away;
  }
  file.mode = best ? *best : file.camera->modes.front();
  format.fmt.pix.pixelformat = file.mode.code;
  format.fmt.pix.width = static_cast<uint32_t>(file.mode.width);
  format.fmt.pix.height = static_cast<uint32_t>(file.mode.height);
  format.fmt.pix.bytesperline = file.camera->stride;
  file.fps = file.mode.rates.empty() ? 30 : file.mode.rates.front();
  return 0;
}

int Parameters(Opened& file, v4l2_streamparm& parameters, bool set) {
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (set && !file.mode.rates.empty() && interval.numerator > 0) {
    const double wanted = static_cast<double>(interval.denominator) / interval.numerator;
    file.fps = *std::min_element(
        file.mode.rates.begin(), file.mode.rates.end(),
        [&](double a, double b) { return std::abs(a - wanted) < std::abs(b - wanted); });
  }
  interval = IntervalOf(file.fps);
  return 0;
}

int Dequeue(int fd, Opened& file, v4l2_buffer& buffer) {
  uint64_t passed = 0;
  if (IsGone(file)) return ENODEV;
  if (read(fd, &passed, sizeof passed) != sizeof passed) return EAGAIN;
  file.next += passed;
  FakeCamera& camera = *file.camera;
  if (file.next > camera.gone_after) {
    TheState().bus.cameras.erase(file.number);
    return ENODEV;
  }
  if (file.queued.empty()) return EAGAIN;
  const size_t i = file.next - 1;
  buffer.index = file.queued.front();
  file.queued.pop_front();
  const std::string bytes = camera.picture(i, file.mode.code);
  const Buffer& memory = file.buffers[buffer.index];
  buffer.bytesused = static_cast<uint32_t>(std::min(bytes.size(), memory.size));
  std::memcpy(memory.memory, bytes.data(), buffer.bytesused);
  const double time = file.start + static_cast<double>(file.next) / file.fps;
  buffer.flags =
      camera.monotonic ? V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC : V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  if (i == camera.damaged) buffer.flags |= V4L2_BUF_FLAG_ERROR;
  buffer.timestamp = {static_cast<time_t>(time),
                      static_cast<suseconds_t>(1e6 * (time - std::floor(time)))};
  buffer.sequence = static_cast<uint32_t>(i);
  return 0;
}

int Control(Opened& file, unsigned long request, void* argument) {
  if (request == VIDIOC_QUERYCTRL) {
    auto& query = *static_cast<v4l2_queryctrl*>(argument);
    const auto found = file.camera->controls.find(query.id);
    if (found == file.camera->controls.end()) return EINVAL;
    query.minimum = found->second.least;
    query.maximum = found->second.most;
    query.step = 1;
    query.flags = 0;
    return 0;
  }
  auto& control = *static_cast<v4l2_control*>(argument);
  const auto found = file.camera->controls.find(control.id);
  if (found == file.camera->controls.end()) return EINVAL;
  FakeControl& known = found->second;
  if (request == VIDIOC_G_CTRL) {
    control.value = known.value;
    return 0;
  }
  if (control.value < known.least || control.value > known.most) return ERANGE;
  known.value = control.value;
  return 0;
}

int Answer(int fd, Opened& file, unsigned long request, void* argument) {
  if (IsGone(file)) return ENODEV;
  FakeCamera& camera = *file.camera;
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& told = *static_cast<v4l2_capability*>(argument);
      Copy(told.card, camera.name);
      Copy(told.bus_info, camera.bus);
      told.capabilities = V4L2_CAP_DEVICE_CAPS;
      told.device_caps = V4L2_CAP_STREAMING |
                         (camera.modes.empty() ? V4L2_CAP_META_CAPTURE : V4L2_CAP_VIDEO_CAPTURE);
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      auto& format = *static_cast<v4l2_fmtdesc*>(argument);
      const std::vector<uint32_t> codes = CodesOf(camera);
      if (format.index >= codes.size()) return EINVAL;
      format.pixelformat = codes[format.index];
      return 0;
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& size = *static_cast<v4l2_frmsizeenum*>(argument);
      uint32_t at = 0;
      for (const FakeMode& mode : camera.modes) {
        if (mode.code != size.pixel_format || at++ != size.index) continue;
        size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
        size.discrete = {static_cast<uint32_t>(mode.width), static_cast<uint32_t>(mode.height)};
        return 0;
      }
      return EINVAL;
    }
    case VIDIOC_ENUM_FRAMEINTERVALS: {
      auto& interval = *static_cast<v4l2_frmivalenum*>(argument);
      for (const FakeMode& mode : camera.modes) {
        if (mode.code != interval.pixel_format || mode.width != static_cast<int>(interval.width) ||
            mode.height != static_cast<int>(interval.height) || interval.index >= mode.rates.size())
          continue;
        interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        interval.discrete = IntervalOf(mode.rates[interval.index]);
        return 0;
      }
      return EINVAL;
    }
    case VIDIOC_S_FMT:
      return SetFormat(file, *static_cast<v4l2_format*>(argument));
    case VIDIOC_S_PARM:
    case VIDIOC_G_PARM:
      return Parameters(file, *static_cast<v4l2_streamparm*>(argument), request == VIDIOC_S_PARM);
    case VIDIOC_REQBUFS: {
      auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
      file.buffers.assign(wanted.count, Buffer{nullptr, BytesOf(file)});
      return 0;
    }
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      if (buffer.index >= file.buffers.size()) return EINVAL;
      buffer.length = static_cast<uint32_t>(file.buffers[buffer.index].size);
      buffer.m.offset = 4096 * buffer.index;
      return 0;
    }
    case VIDIOC_QBUF:
      file.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_DQBUF:
      return Dequeue(fd, file, *static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      if (camera.streams) return EBUSY;
      camera.streams = true;
      file.start = Monotonic();
      SetTimer(fd, file.fps);
      return 0;
    case VIDIOC_STREAMOFF:
      camera.streams = false;
      SetTimer(fd, 0);
      return 0;
    case VIDIOC_QUERYCTRL:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return Control(file, request, argument);
    default:
      return ENOTTY;
  }
}

// The number of "/dev/videoN".
std::optional<int> NumberOf(const char* path) {
  constexpr char kStart[] = "/dev/video";
  if (std::strncmp(path, kStart, sizeof kStart - 1) != 0) return std::nullopt;
  return std::atoi(path + sizeof kStart - 1);
}

int Open(int number) {
  State& state = TheState();
  const std::lock_guard<std::mutex> lock(state.bus.mutex);
  if (const auto error = state.bus.errors.find(number); error != state.bus.errors.end()) {
    errno = error->second;
    return -1;
  }
  const auto camera = state.bus.cameras.find(number);
  if (camera == state.bus.cameras.end()) {
    errno = ENOENT;
    return -1;
  }
  const int fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  ++camera->second->opened;
  Opened& file = state.opened[fd];
  file.number = number;
  file.camera = camera->second;
  return fd;
}

}  // namespace

FakeBus& TheFakeBus() { return TheState().bus; }

void Plug(int number, std::shared_ptr<FakeCamera> camera) {
  const std::lock_guard<std::mutex> lock(TheFakeBus().mutex);
  TheFakeBus().cameras[number] = std::move(camera);
}

void UnplugAll() {
  const std::lock_guard<std::mutex> lock(TheFakeBus().mutex);
  TheFakeBus().cameras.clear();
  TheFakeBus().errors.clear();
}

}  // namespace alidade

using namespace alidade;

extern "C" __attribute__((visibility("default"))) int open(const char* path, int flags, ...) {
  std::va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (const std::optional<int> number = NumberOf(path)) return Open(*number);
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

extern "C" __attribute__((visibility("default"))) int ioctl(int fd, unsigned long request,
                                                            ...) noexcept {
  std::va_list rest;
  va_start(rest, request);
  void* argument = va_arg(rest, void*);
  va_end(rest);
  {
    State& state = TheState();
    const std::lock_guard<std::mutex> lock(state.bus.mutex);
    if (const auto file = state.opened.find(fd); file != state.opened.end()) {
      errno = Answer(fd, file->second, request, argument);
      return errno == 0 ? 0 : -1;
    }
  }
  return static_cast<int>(syscall(SYS_ioctl, fd, request, argument));
}

extern "C" __attribute__((visibility("default"))) void* mmap(void* at, size_t size, int protection,
                                                             int flags, int fd,
                                                             off_t offset) noexcept {
  const auto real = [](void* where, size_t bytes, int access, int how, int file, off_t start) {
    return reinterpret_cast<void*>(syscall(SYS_mmap, where, bytes, access, how, file, start));
  };
  if (fd >= 0 && (flags & MAP_ANONYMOUS) == 0) {
    State& state = TheState();
    const std::lock_guard<std::mutex> lock(state.bus.mutex);
    if (const auto file = state.opened.find(fd); file != state.opened.end()) {
      void* memory = real(nullptr, size, protection, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      file->second.buffers.at(static_cast<size_t>(offset / 4096)).memory =
          static_cast<char*>(memory);
      return memory;
    }
  }
  return real(at, size, protection, flags, fd, offset);
}

extern "C" __attribute__((visibility("default"))) int close(int fd) {
  {
    State& state = TheState();
    const std::lock_guard<std::mutex> lock(state.bus.mutex);
    if (const auto file = state.opened.find(fd); file != state.opened.end()) {
      if (!IsGone(file->second)) file->second.camera->streams = false;
      state.opened.erase(file);
    }
  }
  return static_cast<int>(syscall(SYS_close, fd));
}
