#include "alidade/run/export/own_recording.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/datasets/euroc_recording.h"
#include "alidade/io/files/datasets/folder_recording.h"
#include "alidade/io/files/datasets/kitti_recording.h"
#include "alidade/io/files/datasets/tum_recording.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/sources/any_source.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kWithout[] = ", or export without images (--no-images, no --colors)";

// Share of a keyframe's features that are found again. The same image gives nearly all; those of
// moving objects and settings of the extraction may differ. Other images give less than 1 %.
constexpr double kSameShare = 0.3;
constexpr int kSameBits = 24;  // of 256

json MemberAt(const json& object, const char* name) {
  return object.is_object() && object.contains(name) ? object[name] : json();
}

std::string WordAt(const json& object, const char* name) {
  const json word = MemberAt(object, name);
  return word.is_string() ? word.get<std::string>() : "";
}

int WholeAt(const json& object, const char* name, int otherwise) {
  const json number = MemberAt(object, name);
  return number.is_number_integer() ? number.get<int>() : otherwise;
}

std::string PixelsOf(const Camera& camera) {
  return std::to_string(camera.width) + "x" + std::to_string(camera.height);
}

std::vector<std::string> ImageFilesOf(const std::string& folder, const std::string& kind) {
  Recording recording;
  if (kind == "tum") recording = ReadTumRecording(folder);
  if (kind == "euroc") recording = ReadEurocRecording(folder);
  if (kind == "kitti") recording = ReadKittiRecording(folder);
  if (kind == "images") recording = ReadFolderRecording(folder);
  std::vector<std::string> files;
  for (RecordedFrame& frame : recording.frames) files.push_back(std::move(frame.image));
  return files;
}

ExtractorSettings ExtractionOf(const SavedMap& saved) {
  ExtractorSettings extraction;
  for (const auto& [name, value] : saved.settings) {
    const auto number = ParseNumber(value);
    if (name == "tracker.extractor.features" && number && *number >= 1 && *number <= 1e5)
      extraction.features = static_cast<int>(*number);
  }
  return extraction;
}

}  // namespace

std::string ResultFolderOf(const std::string& path) {
  std::error_code error;
  fs::path folder = fs::absolute(path, error).lexically_normal();
  if (!IsFolder(path)) folder = folder.parent_path();
  return IsFile((folder / kStatsFile).string()) ? folder.string() : "";
}

OwnRecording OpenOwnRecording(const std::string& path, const SavedMap& saved,
                              const std::optional<std::string>& source,
                              const std::optional<std::string>& camera) {
  OwnRecording own;
  own.folder = ResultFolderOf(path);
  json stats;
  if (!own.folder.empty())
    stats = json::parse(ReadFile(own.folder + "/" + kStatsFile), nullptr, false);
  own.path = source.value_or(WordAt(MemberAt(stats, "folder"), "source"));
  if (own.path.empty()) {
    const std::string typed = WordAt(stats, "source");
    ThrowInput(path +
               (IsLiveSource(typed)
                    ? ": its images came from a live source and were not kept: name a "
                      "recording of them with --source"
                    : ": it is not known which recording it is of: name it with --source") +
               kWithout);
  }
  const std::string place = PathOfSource(own.path);
  if (!place.empty() && !IsThere(place)) {
    ThrowInput(own.path + ", the recording of " + path +
               ", is not there any more: name its new place with --source" + kWithout);
  }
  const json reading = MemberAt(stats, "reading");
  SourceOptions options;
  options.sensor = SensorNamed("the sensor of the map", saved.sensor);
  options.color = true;
  options.imu = kNoImu;
  options.first = WholeAt(reading, "first", 0);
  options.last = WholeAt(reading, "last", -1);
  const std::string told_camera = WordAt(reading, "camera");
  if (camera) {
    options.camera_file = camera;
  } else if (!told_camera.empty()) {
    if (!IsThere(CameraFilePath(told_camera))) {
      ThrowInput(told_camera +
                 ", the --camera of that run, is not there any more: name its new "
                 "place with --camera" +
                 std::string(kWithout));
    }
    options.camera_file = told_camera;
  } else if (const json fov = MemberAt(reading, "fov"); fov.is_number()) {
    options.fov_degrees = fov.get<double>();
  }
  own.source = OpenAnySource(own.path, options);
  own.image_files = ImageFilesOf(own.path, own.source->Info().kind);
  const Camera& images = own.source->Info().camera;
  const bool smaller = saved.camera.width < images.width;
  const Camera scaled = smaller ? images.ScaledToWidth(saved.camera.width) : images;
  if (scaled.width != saved.camera.width || scaled.height != saved.camera.height) {
    ThrowInput(own.path + ": its images have " + PixelsOf(images) +
               " pixels, but the map is of images of " + PixelsOf(saved.camera) +
               ": it is another recording than that of the map");
  }
  return own;
}

ImageCheck::ImageCheck(const SavedMap& saved)
    : camera_(saved.camera), extractor_(ExtractionOf(saved)) {}

bool ImageCheck::Shows(const cv::Mat& gray, const KeyFrame& keyframe) {
  cv::Mat image = gray;
  if (image.cols != camera_.width)
    cv::resize(gray, image, {camera_.width, camera_.height}, 0, 0, cv::INTER_AREA);
  const Frame frame = extractor_.Extract(image, camera_, 0, 0);
  const auto place = [](const Keypoint& k) {  // to a hundredth of a pixel
    return std::pair(std::lround(100 * k.raw_x), std::lround(100 * k.raw_y));
  };
  std::multimap<std::pair<long, long>, size_t> found;
  for (size_t i = 0; i < frame.keypoints.size(); ++i) found.emplace(place(frame.keypoints[i]), i);
  size_t again = 0;
  const Frame& known = *keyframe.frame;
  for (size_t i = 0; i < known.keypoints.size(); ++i) {
    const auto [first, end] = found.equal_range(place(known.keypoints[i]));
    for (auto at = first; at != end; ++at) {
      if (frame.keypoints[at->second].level != known.keypoints[i].level) continue;
      if (HammingDistance(frame.descriptors[at->second], known.descriptors[i]) > kSameBits)
        continue;
      ++again;
      break;
    }
  }
  return static_cast<double>(again) >= kSameShare * static_cast<double>(known.keypoints.size());
}

}  // namespace alidade
