#include "alidade/io/camera/v4l2_camera.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/camera/camera_controls.h"
#include "alidade/io/camera/device_file.h"

namespace alidade {
namespace {

constexpr int kMostDevices = 64;
constexpr uint32_t kBuffers = 4;  // one is read while others are filled
// Sizes that are tried where a driver tells a range only.
const cv::Size kUsualSizes[] = {{640, 480}, {1280, 720}, {1920, 1080}};

std::string TextOf(const void* bytes, size_t most) {
  const auto* text = static_cast<const char*>(bytes);
  return {text, strnlen(text, most)};
}

std::string NameOfCode(uint32_t code) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(code >> (8 * i) & 0x7f);
    if (c > ' ') name += c;
  }
  return name;
}

double RateOf(const v4l2_fract& interval) {
  return interval.numerator == 0 ? 0
                                 : static_cast<double>(interval.denominator) / interval.numerator;
}

void AddRates(const DeviceFile& file, CameraMode mode, std::vector<CameraMode>& modes) {
  v4l2_frmivalenum interval{};
  interval.pixel_format = mode.format->code;
  interval.width = static_cast<uint32_t>(mode.size.width);
  interval.height = static_cast<uint32_t>(mode.size.height);
  const size_t before = modes.size();
  for (; file.Ask(VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0; ++interval.index) {
    const bool one = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    mode.fps = RateOf(one ? interval.discrete : interval.stepwise.min);  // the shortest interval
    modes.push_back(mode);
    if (!one) break;
  }
  if (modes.size() > before) return;
  mode.fps = 0;
  modes.push_back(mode);
}

void AddSizes(const DeviceFile& file, const PixelFormat& format, std::vector<CameraMode>& modes) {
  v4l2_frmsizeenum size{};
  size.pixel_format = format.code;
  for (; file.Ask(VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      const cv::Size one(static_cast<int>(size.discrete.width),
                         static_cast<int>(size.discrete.height));
      AddRates(file, {&format, one, 0}, modes);
      continue;
    }
    const v4l2_frmsize_stepwise& range = size.stepwise;
    std::vector<cv::Size> all(std::begin(kUsualSizes), std::end(kUsualSizes));
    all.emplace_back(static_cast<int>(range.max_width), static_cast<int>(range.max_height));
    for (const cv::Size one : all) {
      const auto width = static_cast<uint32_t>(one.width),
                 height = static_cast<uint32_t>(one.height);
      if (width < range.min_width || width > range.max_width || height < range.min_height ||
          height > range.max_height)
        continue;
      AddRates(file, {&format, one, 0}, modes);
    }
    break;
  }
}

// nullopt: the device takes no pictures.
std::optional<CameraDevice> Describe(const std::string& path, const DeviceFile& file) {
  v4l2_capability told{};
  if (file.Ask(VIDIOC_QUERYCAP, &told) != 0) return std::nullopt;
  const uint32_t can =
      (told.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? told.device_caps : told.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) return std::nullopt;
  CameraDevice device;
  device.path = path;
  device.name = TextOf(told.card, sizeof told.card);
  device.bus = TextOf(told.bus_info, sizeof told.bus_info);
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; file.Ask(VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
    if (const PixelFormat* known = FindPixelFormat(format.pixelformat))
      AddSizes(file, *known, device.modes);
    else
      device.others.push_back(NameOfCode(format.pixelformat));
  }
  device.controls = ControlsOf(file);
  return device;
}

std::string WhyNotOpened(const std::string& path, int error) {
  if (error == ENOENT || error == ENXIO || error == ENODEV)
    return "there is no camera " + path + "; `alidade cameras` lists those that are there";
  if (error == EACCES || error == EPERM)
    return path + " may not be read by this user: add the user to the group `video`";
  return path + " cannot be opened: " + std::strerror(error);
}

double MonotonicSeconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class V4l2Camera : public LiveDevice {
 public:
  V4l2Camera(DeviceFile file, CameraDevice device, const CameraRequest& request)
      : file_(std::move(file)), device_(std::move(device)), controls_(file_, request) {
    Start(request);
  }
  ~V4l2Camera() override {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    file_.Ask(VIDIOC_STREAMOFF, &type);
  }
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  double FramesPerSecond() const override { return mode_.fps; }

  std::string Told() const override {
    return device_.name + ", " + NameOf(mode_) +
           (controls_.told().empty() ? "" : ", " + controls_.told());
  }

  Taken Take(double seconds, bool color, LivePicture& picture) override {
    const int ready = file_.Wait(seconds);
    if (ready < 0) return Taken::kGone;
    std::optional<v4l2_buffer> newest;
    while (true) {  // older pictures give way
      v4l2_buffer buffer = Buffer(0);
      const int error = file_.Ask(VIDIOC_DQBUF, &buffer);
      if (error == EAGAIN) break;
      if (error != 0) return Taken::kGone;
      if (newest) file_.Ask(VIDIOC_QBUF, &*newest);
      newest = buffer;
    }
    if (!newest) return Taken::kNothing;
    Read(*newest, color, picture);
    file_.Ask(VIDIOC_QBUF, &*newest);
    return Taken::kPicture;
  }

 private:
  static v4l2_buffer Buffer(uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
  }

  [[noreturn]] void Fail(const char* what, int error) const {
    if (error == EBUSY) ThrowInput(device_.path + " is used by another program");
    ThrowInput(device_.path + ": " + what + " failed: " + std::strerror(error));
  }
  void Try(const char* what, unsigned long request, void* argument) const {
    if (const int error = file_.Ask(request, argument); error != 0) Fail(what, error);
  }

  void Start(const CameraRequest& request) {
    const CameraMode* mode = ChooseMode(device_.modes, request);
    if (mode == nullptr) ThrowUsage(WhyNoMode(request));
    mode_ = *mode;
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<uint32_t>(mode_.size.width);
    format.fmt.pix.height = static_cast<uint32_t>(mode_.size.height);
    format.fmt.pix.pixelformat = mode_.format->code;
    format.fmt.pix.field = V4L2_FIELD_ANY;
    Try("setting the format", VIDIOC_S_FMT, &format);
    // A driver may change what it was asked for.
    const PixelFormat* given = FindPixelFormat(format.fmt.pix.pixelformat);
    if (given == nullptr) ThrowInput(device_.path + " gives images in an unknown format");
    mode_.format = given;
    mode_.size = {static_cast<int>(format.fmt.pix.width), static_cast<int>(format.fmt.pix.height)};
    stride_ = given->bits == 0 ? 0 : format.fmt.pix.bytesperline;
    SetRate(request.fps > 0 ? request.fps : mode_.fps);
    v4l2_requestbuffers wanted{};
    wanted.count = kBuffers;
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.memory = V4L2_MEMORY_MMAP;
    Try("asking for buffers", VIDIOC_REQBUFS, &wanted);
    for (uint32_t i = 0; i < wanted.count; ++i) {
      v4l2_buffer buffer = Buffer(i);
      Try("asking for buffers", VIDIOC_QUERYBUF, &buffer);
      buffers_.emplace_back(file_, buffer.length, buffer.m.offset);
      if (buffers_.back().data() == nullptr) Fail("mapping a buffer", errno);
      Try("queueing a buffer", VIDIOC_QBUF, &buffer);
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    Try("starting", VIDIOC_STREAMON, &type);
  }

  std::string WhyNoMode(const CameraRequest& request) const {
    std::string problem = device_.path + " (" + device_.name + ") has no";
    if (!request.size.empty())
      problem +=
          " " + std::to_string(request.size.width) + " x " + std::to_string(request.size.height);
    if (!request.format.empty()) problem += " " + request.format;
    return problem + " images" + "; `alidade cameras` lists what it can do";
  }

  // Drivers without rates refuse, which is no harm.
  void SetRate(double fps) {
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (fps > 0) {
      parameters.parm.capture.timeperframe = {1000, static_cast<uint32_t>(1000 * fps + 0.5)};
      file_.Ask(VIDIOC_S_PARM, &parameters);
    }
    if (file_.Ask(VIDIOC_G_PARM, &parameters) == 0)
      mode_.fps = RateOf(parameters.parm.capture.timeperframe);
  }

  void Read(const v4l2_buffer& buffer, bool color, LivePicture& picture) const {
    picture = {};
    const bool monotonic =
        (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    picture.time = monotonic ? static_cast<double>(buffer.timestamp.tv_sec) +
                                   1e-6 * static_cast<double>(buffer.timestamp.tv_usec)
                             : MonotonicSeconds();
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || buffer.index >= buffers_.size()) {
      picture.problem = "was damaged on its way from the camera";
      return;
    }
    const MappedBuffer& memory = buffers_[buffer.index];
    const size_t used = std::min<size_t>(buffer.bytesused, memory.size());
    DecodedImage decoded =
        DecodePixels(*mode_.format, mode_.size, stride_, {memory.data(), used}, color);
    picture.image = decoded.image;
    picture.color = decoded.color;
    picture.problem = decoded.problem;
  }

  DeviceFile file_;
  CameraDevice device_;
  CameraControls controls_;
  CameraMode mode_;
  size_t stride_ = 0;  // bytes from row to row; 0: compressed
  std::vector<MappedBuffer> buffers_;
};

// The device that was open before, by name and bus.
std::optional<std::string> PathNowOf(const CameraDevice& wanted) {
  std::optional<std::string> of_name;
  for (const CameraDevice& device : FindCameras()) {
    if (device.name != wanted.name) continue;
    if (device.bus == wanted.bus) return device.path;
    if (!of_name) of_name = device.path;
  }
  return of_name;
}

}  // namespace

std::vector<CameraDevice> FindCameras(std::vector<std::string>* problems) {
  std::vector<CameraDevice> devices;
  for (int i = 0; i < kMostDevices; ++i) {
    const std::string path = "/dev/video" + std::to_string(i);
    const DeviceFile file(path);
    if (!file.valid()) {
      if (problems != nullptr && file.error() != ENOENT)
        problems->push_back(WhyNotOpened(path, file.error()));
      continue;
    }
    if (auto device = Describe(path, file)) devices.push_back(std::move(*device));
  }
  return devices;
}

std::unique_ptr<LiveDevice> OpenV4l2Camera(const CameraRequest& request, const CameraDevice* like) {
  CameraRequest wanted = request;
  if (like != nullptr) {
    const std::optional<std::string> path = PathNowOf(*like);
    if (!path) ThrowInput(like->name + " is not connected");
    wanted.device = *path;
  }
  DeviceFile file(wanted.device);
  if (!file.valid()) ThrowInput(WhyNotOpened(wanted.device, file.error()));
  std::optional<CameraDevice> device = Describe(wanted.device, file);
  if (!device) ThrowInput(wanted.device + " is no camera that takes pictures");
  return std::make_unique<V4l2Camera>(std::move(file), std::move(*device), wanted);
}

}  // namespace alidade
