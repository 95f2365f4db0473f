// Preloaded into the program: one camera that shows the JPEG images of a folder, forward and
// backward. FAKE_V4L2_FOLDER names the folder; FAKE_V4L2_GONE_AFTER, where set, the number of
// images after which the camera is unplugged for a second, to come back as /dev/video2.
#include <linux/videodev2.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "cameras/fake_v4l2.h"

namespace alidade {
namespace {

constexpr int kWidth = 320, kHeight = 240;

std::vector<std::string> ImagesIn(const std::string& folder) {
  std::vector<std::string> paths, images;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    images.push_back(bytes.str());
  }
  return images;
}

struct Preloaded {
  Preloaded() {
    const char* folder = std::getenv("FAKE_V4L2_FOLDER");
    if (folder == nullptr) return;
    const std::vector<std::string> images = ImagesIn(folder);
    const auto camera = std::make_shared<FakeCamera>();
    camera->name = "Rendered Camera";
    camera->bus = "usb-test-1";
    camera->modes = {{V4L2_PIX_FMT_MJPEG, kWidth, kHeight, {30, 15}}};
    camera->controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, 3}},
                        {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 5000, 157}},
                        {V4L2_CID_FOCUS_AUTO, {0, 1, 1}},
                        {V4L2_CID_FOCUS_ABSOLUTE, {0, 250, 30}}};
    const size_t last = images.size() - 1;
    camera->picture = [images, last](size_t i, uint32_t) {
      const size_t at = i % (2 * last);
      return images[at <= last ? at : 2 * last - at];
    };
    Plug(0, camera);
    const char* gone = std::getenv("FAKE_V4L2_GONE_AFTER");
    if (gone == nullptr) return;
    camera->gone_after = std::stoul(gone);
    const auto again = std::make_shared<FakeCamera>(*camera);
    again->gone_after = SIZE_MAX;
    again->picture = [picture = camera->picture, from = camera->gone_after](
                         size_t i, uint32_t code) { return picture(from + i, code); };
    std::thread([camera, again] {
      const auto plugged = [&] {
        const std::lock_guard<std::mutex> lock(TheFakeBus().mutex);
        return TheFakeBus().cameras.count(0) != 0;
      };
      while (plugged()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      std::this_thread::sleep_for(std::chrono::seconds(1));
      Plug(2, again);
    }).detach();
  }
};
const Preloaded preloaded;

}  // namespace
}  // namespace alidade
