#include "alidade/io/camera/stream_device.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "alidade/io/files/media.h"

namespace alidade {
namespace {

double MonotonicNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class StreamDevice : public LiveDevice {
 public:
  StreamDevice(std::unique_ptr<MediaStream> stream, bool by_arrival)
      : stream_(std::move(stream)), by_arrival_(by_arrival) {}

  // Waits for as long as the media module does.
  Taken Take(double, bool color, LivePicture& picture) override {
    if (!stream_->Grab()) return Taken::kGone;
    picture = {};
    const double now = MonotonicNow(), told = stream_->Time();
    if (!start_) start_ = now - told;
    picture.time = by_arrival_ ? now : *start_ + told;
    picture.image = stream_->Gray();
    if (color) picture.color = stream_->Color();
    if (picture.image.empty()) picture.problem = "cannot be decoded";
    return Taken::kPicture;
  }
  void Stop() override { stream_->Interrupt(); }
  double FramesPerSecond() const override { return by_arrival_ ? 0 : stream_->FramesPerSecond(); }
  std::string Told() const override { return "a stream of the network"; }

 private:
  std::unique_ptr<MediaStream> stream_;
  // An http stream of JPEG images has no times of its own.
  bool by_arrival_;
  std::optional<double> start_;  // of the stream's clock, seconds of the monotonic one
};

}  // namespace

std::unique_ptr<LiveDevice> OpenStreamDevice(const std::string& address) {
  return std::make_unique<StreamDevice>(OpenLiveVideo(address, AddressToShow(address)),
                                        address.compare(0, 4, "http") == 0);
}

std::string AddressToShow(const std::string& address) {
  const size_t start = address.find("://") + 3;
  const size_t slash = std::min(address.find('/', start), address.size());
  const size_t at = address.rfind('@', slash);
  if (at == std::string::npos || at < start || at > slash) return address;
  return address.substr(0, start) + address.substr(at + 1);
}

}  // namespace alidade
