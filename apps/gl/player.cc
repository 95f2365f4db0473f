#include "player.h"

#include <filesystem>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/io/files/image_codec.h"

namespace alidade::gl_app {
namespace {

std::string StreamOf(const std::string& what) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(what, error)) return what;
  const std::string file = (fs::path(what) / "run.stream").string();
  if (!fs::exists(file, error))
    ThrowInput(what + " contains no run.stream (`alidade run --record` writes one)");
  return file;
}

std::string NameFor(const std::string& what) {
  std::filesystem::path path(what);
  if (path.filename() == "run.stream") path = path.parent_path();
  if (path.filename().empty()) path = path.parent_path();
  return path.empty() ? what : path.filename().string();
}

}  // namespace

StreamPlayer::StreamPlayer(const std::string& what)
    : reader_(StreamOf(what)), name_(NameFor(what)) {}

void StreamPlayer::PlayTo(double seconds) {
  while (!ended_ && (!begun_ || scene_.now.time - first_ < seconds)) {
    const auto message = reader_.Next();
    if (!message) {
      ended_ = true;
      return;
    }
    const int before = scene_.frames;
    scene_.Take(*message);
    if (scene_.frames == before) continue;
    if (!begun_) first_ = scene_.now.time;
    begun_ = true;
    if (!scene_.now.picture.empty()) picture_ = scene_.now.picture;
  }
}

cv::Mat StreamPlayer::TakePicture() {
  if (picture_.empty()) return {};
  cv::Mat image = DecodeJpeg(picture_, ImageUse::kGray).image;  // none of a damaged one
  picture_.clear();
  return image;
}

std::string StreamPlayer::Title() const {
  static const char* const kStates[] = {"initializing", "tracking", "lost"};
  const SceneNow& now = scene_.now;
  const auto state = static_cast<size_t>(now.state);
  return name_ + ": " + std::to_string(now.keyframes) + " keyframes, " +
         std::to_string(now.landmarks) + " points, " + std::to_string(now.matches) + " matches, " +
         (state < 3 ? kStates[state] : "unknown") + (ended_ ? " (ended)" : "");
}

}  // namespace alidade::gl_app
