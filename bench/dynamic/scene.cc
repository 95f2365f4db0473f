#include "bench/dynamic/scene.h"

#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/evaluation/association.h"
#include "alidade/io/files/datasets/stamped_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/text.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/synth_source.h"
#include "bench/measure/recording.h"

namespace alidade::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime = 0.005;  // seconds: less than half a frame of any camera

// Specks are no persons.
std::vector<cv::Rect> BoxesAround(const cv::Mat& mask) {
  constexpr int kLeastPixels = 64;
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres);
  std::vector<cv::Rect> boxes;
  for (int i = 1; i < count; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) < kLeastPixels) continue;
    boxes.push_back({stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                     stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)});
  }
  return boxes;
}

// Index of the frame taken at that time; -1: none.
int FrameAt(const DynamicScene& scene, const std::vector<double>& stamps, double time) {
  const int i = NearestStamp(stamps, time);
  return std::abs(scene.frames[static_cast<size_t>(i)].time - time) <= kSameTime ? i : -1;
}

void ReadMasks(const std::string& folder, const std::vector<double>& stamps, DynamicScene& scene) {
  const std::string list = folder + "/mask.txt";
  if (!fs::is_regular_file(list)) return;
  scene.masks.resize(scene.frames.size());
  for (const StampedName& line : ReadStampedList(list, StampUnit::kSeconds, true)) {
    if (!line.problem.empty()) ThrowInput(line.problem);
    const int i = FrameAt(scene, stamps, line.time);
    if (i < 0) continue;
    const std::string path = folder + "/" + line.name;
    cv::Mat mask = ReadImageGray(path) >= 128;
    if (mask.size() != scene.frames[static_cast<size_t>(i)].image.size())
      ThrowInput(path + " is of another size than the frame");
    scene.masks[static_cast<size_t>(i)] = std::move(mask);
  }
}

// people.txt: timestamp, id, what, x y width height, …; false when there is none.
bool ReadPeople(const std::string& folder, const std::vector<double>& stamps, DynamicScene& scene) {
  const std::string path = folder + "/people.txt";
  if (!fs::is_regular_file(path)) return false;
  const std::string text = ReadFile(path);
  for (const TextLine& line : ContentLines(text)) {
    const auto fields = Fields(line.text);
    std::vector<double> numbers;
    for (const size_t field : {0, 3, 4, 5, 6}) {
      const auto number = field < fields.size() ? ParseNumber(fields[field]) : std::nullopt;
      if (!number || !(std::abs(*number) < 1e10))
        ThrowInput(path + ":" + std::to_string(line.number) + ": expected time id what x y w h");
      numbers.push_back(*number);
    }
    const int i = FrameAt(scene, stamps, numbers[0]);
    if (i < 0) continue;
    scene.people[static_cast<size_t>(i)].push_back(
        {cvRound(numbers[1]), cvRound(numbers[2]), cvRound(numbers[3]), cvRound(numbers[4])});
  }
  return true;
}

void LoadRendered(int first, int last, DynamicScene& scene) {
  const auto opened = OpenActorSource(scene.source);
  scene.info = opened->Info();
  opened->Seek(first);
  while (auto frame = opened->Next()) {
    if (last >= 0 && frame->number > last) break;
    scene.truth.push_back({frame->time, *frame->T_world_camera, frame->stamp});
    frame->true_depth.release();
    scene.masks.push_back(opened->ActorMask());
    scene.frames.push_back(std::move(*frame));
  }
  if (ParseSynthSource(scene.source).actors == 0) scene.masks.clear();
}

void LoadRecorded(const SourceOptions& options, DynamicScene& scene) {
  const auto opened = OpenAnySource(scene.source, options);
  scene.info = opened->Info();
  while (auto frame = opened->Next()) {
    if (frame->problem.empty()) scene.frames.push_back(std::move(*frame));
  }
  scene.truth = ReadTrajectory(scene.source);
}

}  // namespace

DynamicScene LoadDynamicScene(const std::string& source, int first, int last, bool color,
                              const std::optional<std::string>& camera_file) {
  DynamicScene scene;
  scene.source = source;
  scene.name = ShortName(source);
  const bool rendered = IsSynthSource(source);
  if (rendered) {
    LoadRendered(first, last, scene);
  } else {
    SourceOptions options;
    options.camera_file = camera_file;
    options.first = first;
    options.last = last;
    options.color = color;
    LoadRecorded(options, scene);
  }
  if (scene.frames.size() < 2) ThrowInput(source + " has fewer than 2 frames that can be read");
  std::vector<double> stamps;
  for (const SourceFrame& frame : scene.frames) stamps.push_back(frame.time);
  if (!rendered) ReadMasks(source, stamps, scene);
  if (!scene.has_masks()) return scene;
  scene.people.resize(scene.frames.size());
  if (!rendered && ReadPeople(source, stamps, scene)) return scene;
  for (size_t i = 0; i < scene.masks.size(); ++i) {
    if (!scene.masks[i].empty()) scene.people[i] = BoxesAround(scene.masks[i]);
  }
  return scene;
}

}  // namespace alidade::bench
