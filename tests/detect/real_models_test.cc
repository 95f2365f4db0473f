// Networks with real weights on real images, compared with labeled people. Uses the user's files:
// recordings under ALIDADE_DATA, networks in the folder models beside it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "alidade/detect/onnx/open_detector.h"
#include "alidade/detect/suppress.h"
#include "support/temp_folder.h"

namespace alidade::real_models_test {
namespace {

constexpr float kSameThing = 0.5f;  // overlap of a match
// Smaller people are ignored, as in the data's README.
constexpr float kLeastArea = 0.01f * 640 * 480;

std::string ModelPath(const std::string& name) { return DataFolder() + "/../models/" + name; }

// Visible boxes of people, by time stamp as written.
std::map<std::string, std::vector<cv::Rect2f>> ReadPeople(const std::string& recording) {
  std::map<std::string, std::vector<cv::Rect2f>> people;
  std::ifstream file(DataFolder() + "/" + recording + "/people.txt");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string time, id, cutout;
    cv::Rect2f box;
    float visible = 0;
    words >> time >> id >> cutout >> box.x >> box.y >> box.width >> box.height >> visible;
    if (words && time[0] != '#' && visible > kLeastArea) people[time].push_back(box);
  }
  return people;
}

struct Recall {
  int found = 0, all = 0;
  double share() const { return all > 0 ? static_cast<double>(found) / all : 0; }
};

// Evaluates every `step`-th frame.
Recall RecallOfPeople(const std::string& model, const std::string& recording, int step) {
  const auto detector = OpenDetector(ModelPath(model));
  Recall recall;
  int frame = 0;
  for (const auto& [time, people] : ReadPeople(recording)) {
    if (frame++ % step != 0) continue;
    const cv::Mat image = cv::imread(DataFolder() + "/" + recording + "/rgb/" + time + ".jpg");
    const std::vector<Detection> detections = detector->Detect(image);
    for (const cv::Rect2f& person : people) {
      ++recall.all;
      recall.found += std::any_of(detections.begin(), detections.end(), [&](const Detection& one) {
        return detector->ClassNames().at(one.class_id) == "person" &&
               Overlap(one.box, person) > kSameThing;
      });
    }
  }
  std::printf("%s on %s: %d of %d people, %.3f\n", model.c_str(), recording.c_str(), recall.found,
              recall.all, recall.share());
  return recall;
}

class RealModels : public testing::Test {
 protected:
  void SetUp() override {
    if (DataFolder().empty() || !std::filesystem::exists(ModelPath("")))
      GTEST_SKIP() << "needs ALIDADE_DATA, and the folder models beside it";
  }
};

// Reference recall on all frames, by another program: 0.898 of 939 people, and 0.773 of 449. The
// standard deviation of a share of n people is sqrt(p (1 - p) / n), here 0.05 and 0.08; the bounds
// are two of these below.
TEST_F(RealModels, Yolov5sFindsWalkingPeople) {
  EXPECT_GT(RecallOfPeople("yolov5s_640x480.onnx", "kitchen_walk", 20).share(), 0.79);
}
TEST_F(RealModels, Yolov5sFindsPeopleWhoStay) {
  EXPECT_GT(RecallOfPeople("yolov5s_640x480.onnx", "kitchen_sit", 15).share(), 0.61);
}

// Without reference values: most people are found, whereas wrong colors, sizes or coordinates would
// give nearly none.
TEST_F(RealModels, Yolov5nFindsMostPeople) {
  EXPECT_GT(RecallOfPeople("yolov5n_640x480.onnx", "kitchen_walk", 30).share(), 0.6);
}
TEST_F(RealModels, YoloxFindsMostPeople) {
  EXPECT_GT(RecallOfPeople("yolox_nano_416.onnx", "kitchen_walk", 30).share(), 0.6);
}

}  // namespace
}  // namespace alidade::real_models_test
