#include "alidade/io/files/datasets/kitti_recording.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/kitti_calibration.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

// The places in times.txt of images that are named by consecutive numbers, of which some are
// missing; empty when the names are not such numbers. The first is 0, unless the last would then
// be beyond the list.
std::vector<size_t> PlacesByNumber(const std::vector<std::string>& images, size_t times) {
  std::vector<size_t> places;
  for (const std::string& image : images) {
    const std::string stem = fs::path(image).stem().string();
    size_t number = 0;
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
    if (error != std::errc() || end != stem.data() + stem.size()) return {};
    if (!places.empty() && number <= places.back()) return {};
    places.push_back(number);
  }
  if (places.empty()) return {};
  const size_t first = places.back() < times ? 0 : places.front();
  for (size_t& place : places) place -= first;
  return places.back() < times ? places : std::vector<size_t>();
}

// The entries of `list` that have an image, with its name.
std::vector<StampedName> WithImages(const std::vector<StampedName>& list,
                                    const std::vector<std::string>& images,
                                    const std::string& folder) {
  const std::vector<size_t> places =
      images.size() < list.size() ? PlacesByNumber(images, list.size()) : std::vector<size_t>();
  const std::string counts = folder + "/times.txt has " + std::to_string(list.size()) +
                             " times for " + std::to_string(images.size()) + " images: ";
  if (!places.empty()) {
    const size_t missing = list.size() - images.size();
    LogWarning(counts + std::to_string(missing) + (missing == 1 ? " is" : " are") +
               " missing by their numbers; the others keep their times");
  } else if (images.size() != list.size()) {
    LogWarning(counts + "frames without one of them are ignored");
  }
  std::vector<StampedName> paired;
  for (size_t i = 0; i < std::min(images.size(), list.size()); ++i) {
    paired.push_back(list[places.empty() ? i : places[i]]);
    paired.back().name = images[i];
  }
  return paired;
}

}  // namespace

bool IsKittiFolder(const std::string& folder) {
  return IsThere(folder + "/times.txt") &&
         (IsFolder(folder + "/image_0") || IsFolder(folder + "/image_2"));
}

Recording ReadKittiRecording(const std::string& folder) {
  const int left = IsFolder(folder + "/image_0") ? 0 : 2;
  const std::string left_folder = folder + "/image_" + std::to_string(left);
  const std::string right_folder = folder + "/image_" + std::to_string(left + 1);
  const auto images = ImagesIn(left_folder);
  const auto times =
      ReadStampedList(folder + "/times.txt", StampUnit::kSeconds, false, FindUnit::kYes);
  if (images.empty()) ThrowInput(left_folder + " contains no images");
  Recording recording;
  recording.kind = "kitti";
  recording.frames = FramesOf(WithImages(times, images, folder), left_folder);
  if (IsFolder(right_folder)) {
    for (RecordedFrame& frame : recording.frames) {
      const std::string right = right_folder + "/" + fs::path(frame.image).filename().string();
      if (!IsThere(right)) continue;
      frame.right = right;
      recording.has_right = true;
    }
  }
  const std::string calibration = folder + "/calib.txt";
  if (IsThere(calibration)) {
    recording.calibration = ReadKittiCalibration(calibration, left, SizeOfImages(recording));
  }
  return recording;
}

}  // namespace alidade
