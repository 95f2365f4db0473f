// From a file to detections: networks written by the test, run by OpenCV.
#include "alidade/detect/onnx/open_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "alidade/base/random.h"
#include "alidade/detect/model_file.h"
#include "detect/tiny_network.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::open_detector_test {
namespace {

using testing::HasSubstr;

class OpenDetectorTest : public testing::Test {
 protected:
  std::unique_ptr<Detector> Open(const std::string& bytes) const {
    return OpenDetector(folder_.Write("net.onnx", bytes));
  }
  // The error of opening these bytes; it must name the file, and nothing else may be printed.
  std::string Complaint(const std::string& bytes) const {
    const std::string path = folder_.Write("net.onnx", bytes);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const std::string message = MessageOf(ErrorKind::kInput, [&] { OpenDetector(path); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_THAT(message, HasSubstr(path + ": "));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  TempFolder folder_;
};

// YOLOv5's layout: a single detection of class 1 in the middle.
TinyNetwork WithOneThing() {
  TinyNetwork network({1, 3 * kTinyCells, 7}, 0);
  const float row[7] = {16, 14, 8, 20, 0.9f, 0.1f, 0.8f};
  for (int i = 0; i < 7; ++i) network.At(40, i) = row[i];
  return network;
}

const cv::Mat kPicture(32, 32, CV_8UC3, cv::Scalar(10, 100, 200));  // blue, green, red

TEST_F(OpenDetectorTest, FindsWhatTheNetworkSays) {
  const auto detector = Open(WithOneThing().Bytes());
  const std::vector<Detection> found = detector->Detect(kPicture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].class_id, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.72f);
  EXPECT_EQ(found[0].box, cv::Rect2f(12, 4, 8, 20));
  EXPECT_EQ(detector->ClassNames(), (std::vector<std::string>{"class 0", "class 1"}));
}

TEST_F(OpenDetectorTest, AnswersInPixelsOfTheImageGiven) {
  const auto detector = Open(WithOneThing().Bytes());
  const cv::Mat wide(32, 64, CV_8UC3, cv::Scalar::all(0));  // 8 rows of margin above and below
  const std::vector<Detection> found = detector->Detect(wide);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].box, cv::Rect2f(24, 0, 16, 32));  // 4…24 minus 8, times 2: clipped
}

TEST_F(OpenDetectorTest, SuppressesWhatIsFoundTwice) {
  TinyNetwork network = WithOneThing();
  for (int i = 0; i < 7; ++i) network.At(41, i) = network.At(40, i);
  network.At(41, 0) += 1;
  network.At(41, 4) = 0.95f;
  const std::vector<Detection> found = Open(network.Bytes())->Detect(kPicture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FLOAT_EQ(found[0].score, 0.76f);
}

TEST_F(OpenDetectorTest, LeavesOutWhatScoresTooLittle) {
  const std::string path = folder_.Write("net.onnx", WithOneThing().Bytes());
  EXPECT_EQ(OpenDetector(path, {.min_score = 0.71f})->Detect(kPicture).size(), 1u);
  EXPECT_EQ(OpenDetector(path, {.min_score = 0.73f})->Detect(kPicture).size(), 0u);
}

TEST_F(OpenDetectorTest, TakesTheNamesInTheFile) {
  TinyNetwork network = WithOneThing();
  network.names = "{0: 'robot', 1: \"robot's cat\"}";
  EXPECT_EQ(Open(network.Bytes())->ClassNames(),
            (std::vector<std::string>{"robot", "robot's cat"}));
}

// Reads an input value of the network from a score that is the mean of one input plane.
float ScoreOfPlane(TinyNetwork network, int plane, float factor, const std::string& path,
                   const cv::Mat& image) {
  const int score = network.shape[1] < network.shape[2] ? 4 * kTinyCells + 3  // transposed
                                                        : static_cast<int>(network.Index(3, 5));
  network.values[static_cast<size_t>(score)] = 0;
  network.dependences = {{static_cast<size_t>(score), plane, factor}};
  TempFolder folder;
  const auto detector = OpenDetector(folder.Write(path, network.Bytes()), {.min_score = 0.001f});
  const std::vector<Detection> found = detector->Detect(image);
  return found.empty() ? 0 : found[0].score;
}

TEST_F(OpenDetectorTest, GivesYolov5RedGreenBlueFrom0To1) {
  TinyNetwork network = WithOneThing();
  network.At(40, 4) = 0;
  const float row[5] = {16, 16, 20, 20, 1};
  for (int i = 0; i < 5; ++i) network.At(3, i) = row[i];
  EXPECT_NEAR(ScoreOfPlane(network, 0, 1, "a", kPicture), 200.0 / 255, 1e-5);
  EXPECT_NEAR(ScoreOfPlane(network, 1, 1, "a", kPicture), 100.0 / 255, 1e-5);
  EXPECT_NEAR(ScoreOfPlane(network, 2, 1, "a", kPicture), 10.0 / 255, 1e-5);
  const cv::Mat grey(32, 32, CV_8UC1, cv::Scalar(51));
  for (const int plane : {0, 1, 2})
    EXPECT_NEAR(ScoreOfPlane(network, plane, 1, "a", grey), 51.0 / 255, 1e-5);
}

TEST_F(OpenDetectorTest, GivesYolov8RedGreenBlueFrom0To1) {
  TinyNetwork network({1, 5, kTinyCells}, 0);
  for (const int column : {0, 1, 2, 3}) network.At(column, 3) = 16;
  EXPECT_NEAR(ScoreOfPlane(network, 0, 1, "a", kPicture), 200.0 / 255, 1e-5);
  EXPECT_NEAR(ScoreOfPlane(network, 2, 1, "a", kPicture), 10.0 / 255, 1e-5);
}

TEST_F(OpenDetectorTest, GivesYoloxBlueGreenRedFrom0To255) {
  TinyNetwork network({1, kTinyCells, 6}, 0);
  network.At(3, 4) = 1;
  EXPECT_NEAR(ScoreOfPlane(network, 0, 1.0f / 255, "a", kPicture), 10.0 / 255, 1e-5);
  EXPECT_NEAR(ScoreOfPlane(network, 2, 1.0f / 255, "a", kPicture), 200.0 / 255, 1e-5);
}

TEST_F(OpenDetectorTest, GivesNetworksThatScaleTheirInputRedGreenBlueFrom0To255) {
  TinyNetwork network({1, kTinyCells, 6}, 0);
  network.At(3, 4) = 1;
  network.scales_input = true;
  EXPECT_NEAR(ScoreOfPlane(network, 0, 1.0f / 255, "a", kPicture), 200.0 / 255, 1e-5);
  EXPECT_NEAR(ScoreOfPlane(network, 2, 1.0f / 255, "a", kPicture), 10.0 / 255, 1e-5);
}

TEST_F(OpenDetectorTest, GivesYolov6RedGreenBlueFrom0To1) {
  TinyNetwork network({1, kTinyCells, 6}, 0);
  for (int row = 0; row < kTinyCells; ++row) network.At(row, 4) = 1;
  EXPECT_NEAR(ScoreOfPlane(network, 0, 1, "a", kPicture), 200.0 / 255, 1e-5);
}

// The last layers of YOLOv8 as written by its exporter with simplification: each side of a box is a
// distribution over 16 distances from the cell's center, in strides (Li et al. 2020). The exporter
// writes the strides once; `stride_rows` 4 repeats them for each side.
std::string LastLayersOfYolov8(int stride_rows) {
  constexpr int kBins = 16, kSides = 4, kClasses = 2, kRows = kSides * kBins + kClasses;
  TinyNetwork network({1, kRows, kTinyCells}, 0);
  const int cell = 5, distances[kSides] = {1, 0, 2, 1};  // left, top, right, bottom
  for (int side = 0; side < kSides; ++side)
    network.At(kBins * side + distances[side], cell) = 60;  // nearly certain
  for (int i = 0; i < kTinyCells; ++i) {
    network.At(kRows - 2, i) = -9;
    network.At(kRows - 1, i) = i == cell ? 9 : -9;
  }
  std::vector<float> centres, strides, bins;
  for (const int axis : {0, 1}) {
    for (const int stride : {8, 16, 32}) {
      const int row = kTinySide / stride;
      for (int i = 0; i < row * row; ++i) {
        centres.push_back(static_cast<float>(axis == 0 ? i % row : i / row) + 0.5f);
      }
    }
  }
  for (int row = 0; row < stride_rows; ++row) {
    for (int i = 0; i < kTinyCells; ++i) strides.push_back(i < 16 ? 8 : i < 20 ? 16 : 32);
  }
  for (int i = 0; i < kBins; ++i) bins.push_back(static_cast<float>(i));

  OnnxFile file = network.File("heads");
  const auto slice = [&file](const std::string& from, const std::string& to, int64_t a, int64_t b) {
    file.Constant(to + ".a", {a}).Constant(to + ".b", {b}).Constant(to + ".axis", {1});
    file.Node("Slice", {from, to + ".a", to + ".b", to + ".axis"}, to);
  };
  slice("heads", "sides", 0, kSides * kBins);
  slice("heads", "classes", kSides * kBins, kRows);
  file.Constant("shape4", {1, kSides, kBins, kTinyCells})
      .Constant("shape3", {1, kSides, kTinyCells});
  file.Constant("bins", {1, kBins, 1, 1}, bins);
  file.Node("Reshape", {"sides", "shape4"}, "split");
  file.Node("Transpose", {"split"}, "turned", {{"perm", {0, 2, 1, 3}}});
  file.Node("Softmax", {"turned"}, "likely", {{"axis", {1}}});
  file.Node("Conv", {"likely", "bins"}, "mean", {{"kernel_shape", {1, 1}}});
  file.Node("Reshape", {"mean", "shape3"}, "distances");
  slice("distances", "to_left_top", 0, 2);
  slice("distances", "to_right_bottom", 2, 4);
  file.Constant("centres", {1, 2, kTinyCells}, centres).Constant("two", {1}, {2.0f});
  file.Constant("strides", {1, stride_rows, kTinyCells}, strides);
  file.Node("Sub", {"centres", "to_left_top"}, "left_top");
  file.Node("Add", {"centres", "to_right_bottom"}, "right_bottom");
  file.Node("Add", {"left_top", "right_bottom"}, "sum").Node("Div", {"sum", "two"}, "middle");
  file.Node("Sub", {"right_bottom", "left_top"}, "size");
  file.Node("Concat", {"middle", "size"}, "box", {{"axis", {1}}});
  file.Node("Mul", {"box", "strides"}, "pixels").Node("Sigmoid", {"classes"}, "scores");
  file.Node("Concat", {"pixels", "scores"}, "output0", {{"axis", {1}}});
  return file.Output("output0", {1, kSides + kClasses, kTinyCells}).Bytes();
}

TEST_F(OpenDetectorTest, RunsTheLastLayersOfYolov8) {
  const auto detector = Open(LastLayersOfYolov8(4));
  const std::vector<Detection> found = detector->Detect(kPicture);
  ASSERT_EQ(found.size(), 1u);  // cell center (1.5, 1.5) · 8: from (4, 12) to (28, 20)
  EXPECT_EQ(found[0].class_id, 1);
  EXPECT_NEAR(found[0].box.x, 4, 1e-3);
  EXPECT_NEAR(found[0].box.y, 12, 1e-3);
  EXPECT_NEAR(found[0].box.width, 24, 1e-3);
  EXPECT_NEAR(found[0].box.height, 8, 1e-3);
}

TEST_F(OpenDetectorTest, SaysWhatThisOpenCvCannotRun) {
  if (CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR > 6) GTEST_SKIP() << "newer ones can";
  EXPECT_THAT(Complaint(LastLayersOfYolov8(1)), HasSubstr("a newer OpenCV"));
}

TEST_F(OpenDetectorTest, RunsNetworksThatSuppressThemselves) {
  TinyNetwork network({1, 4, 6}, 0);
  const float row[6] = {2, 4, 20, 30, 0.5f, 7};
  for (int i = 0; i < 6; ++i) network.At(2, i) = row[i];
  const auto detector = Open(network.Bytes());
  const std::vector<Detection> found = detector->Detect(kPicture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].box, cv::Rect2f(2, 4, 18, 26));
  // From COCO.
  EXPECT_EQ(detector->ClassNames().at(static_cast<size_t>(found[0].class_id)), "truck");
  network.names = "['only one']";
  const auto other = Open(network.Bytes());
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { other->Detect(kPicture); }),
              HasSubstr("class 7 of 1"));
}

TEST_F(OpenDetectorTest, SaysWhatIsWrongWithAFile) {
  const std::string good = WithOneThing().Bytes();
  EXPECT_THAT(Complaint(""), HasSubstr("is empty"));
  EXPECT_THAT(Complaint("# a network\nlayers: 3\n"), HasSubstr("is not an ONNX file"));
  EXPECT_THAT(Complaint("\x89PNG\r\n\x1a\n0000IHDR"), HasSubstr("is not an ONNX file"));
  EXPECT_THAT(Complaint(good.substr(0, good.size() / 2)), HasSubstr("truncated"));
  EXPECT_THAT(Complaint(good.substr(0, good.size() - 1)), HasSubstr("truncated"));
  EXPECT_THAT(Complaint(OnnxFile().Bytes()), HasSubstr("contains no network"));
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    std::string bytes(1000, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random.Below(256));
    Complaint(bytes);
  }
}

// OpenCV does not validate files and crashes on many of these.
TEST_F(OpenDetectorTest, SurvivesDamagedFiles) {
  TinyNetwork network = WithOneThing();
  network.scales_input = true;
  const std::string good = network.Bytes();
  Random random(5);
  int opened = 0;
  for (int round = 0; round < 400; ++round) {
    std::string bytes = good;
    const uint32_t changes = 1 + random.Below(3);
    for (uint32_t i = 0; i < changes; ++i) {
      // Half of the changes are near either end, where names, lengths and shapes are.
      const auto near = static_cast<uint32_t>(random.Below(2) == 0 ? 300 : bytes.size());
      const uint32_t at = random.Below(near);
      const bool from_end = random.Below(2) == 0;
      bytes[from_end ? bytes.size() - 1 - at : at] = static_cast<char>(random.Below(256));
    }
    try {
      Open(bytes)->Detect(kPicture);
      ++opened;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    }
  }
  EXPECT_GT(opened, 20);
  EXPECT_LT(opened, 380);
}

TEST_F(OpenDetectorTest, SaysWhyAFileCannotBeRead) {
  const auto message = [&](const std::string& path) {
    return MessageOf(ErrorKind::kInput, [&] { OpenDetector(path); });
  };
  EXPECT_EQ(message(folder_ / "none.onnx"), folder_ / "none.onnx: there is no such file");
  EXPECT_EQ(message(folder_.path()), folder_.path() + ": is not a file");
  EXPECT_EQ(message("/dev/null"), "/dev/null: is not a file");
}

// Sparse files take no disk space but would take all memory when read.
TEST_F(OpenDetectorTest, FilesTooLongOrOfZerosAreRefusedUnread) {
  const std::string path = folder_.Write("net.onnx", WithOneThing().Bytes());
  const auto message = [&] { return MessageOf(ErrorKind::kInput, [&] { OpenDetector(path); }); };
  std::filesystem::resize_file(path, uintmax_t{1} << 42);  // 4 TB
  EXPECT_EQ(message(), path + ": is longer than 1024 MB, which is too long for a detector");
  folder_.Write("net.onnx", "");
  EXPECT_EQ(message(), path + ": is empty");
  MessageOf(ErrorKind::kInput, [] { CheckOnnxStart(std::string_view("\0", 1)); });
}

TEST_F(OpenDetectorTest, SaysWhichOperatorOpenCvLacks) {
  OnnxFile file;
  file.Input("images", {1, 3, 32, 32}).Node("Frobnicate", {"images"}, "output0");
  file.Output("output0", {1, 63, 7});
  EXPECT_THAT(Complaint(file.Bytes()), HasSubstr("operator Frobnicate"));
}

TEST_F(OpenDetectorTest, SaysWhatOutputsItFoundAndWhichItKnows) {
  EXPECT_THAT(Complaint(TinyNetwork({1, 62, 7}, 0).Bytes()), HasSubstr("[1, 62, 7]"));
  const std::string message = Complaint(TinyNetwork({1, 1000}, 0).Bytes());  // a classifier
  EXPECT_THAT(message, HasSubstr("[1, 1000]"));
  EXPECT_THAT(message, HasSubstr("[1, 63, 5+C]"));
}

TEST_F(OpenDetectorTest, SaysThatOutputsAreNotFiniteOrNoScores) {
  for (const float value : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    TinyNetwork network = WithOneThing();
    network.At(3, 2) = value;
    EXPECT_THAT(Complaint(network.Bytes()), HasSubstr("not finite"));
  }
  TinyNetwork network = WithOneThing();
  network.At(3, 5) = -4.5f;
  EXPECT_THAT(Complaint(network.Bytes()), HasSubstr("-4.5"));
}

// A gray image works; the first white image makes the value overflow.
TEST_F(OpenDetectorTest, SaysThatOutputsBecameNotFiniteLater) {
  TinyNetwork network = WithOneThing();
  network.dependences = {{network.Index(0, 0), 0, 3e38f}, {network.Index(0, 0), 1, 3e38f}};
  const auto detector = Open(network.Bytes());
  const cv::Mat white(32, 32, CV_8UC3, cv::Scalar::all(255));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { detector->Detect(white); }),
              HasSubstr("net.onnx: the network gives values that are not finite"));
  EXPECT_EQ(detector->Detect(cv::Mat(32, 32, CV_8UC3, cv::Scalar::all(0))).size(), 1u);
}

TEST_F(OpenDetectorTest, SaysWhichInputsItTakes) {
  const auto complaint = [&](std::vector<int64_t> input) {
    TinyNetwork network = WithOneThing();
    network.input = std::move(input);
    return Complaint(network.Bytes());
  };
  EXPECT_THAT(complaint({1, 3, 100, 32}), HasSubstr("32x100: sides must be multiples of 32"));
  EXPECT_THAT(complaint({1, 3, 32, 1 << 20}), HasSubstr("at most 4096"));
  EXPECT_THAT(complaint({1, 1, 32, 32}), HasSubstr("color images"));
  EXPECT_THAT(complaint({1, 3, 32}), HasSubstr("color images"));
  EXPECT_THAT(complaint({8, 3, 32, 32}), HasSubstr("batch size 1"));
  OnnxFile bytes = WithOneThing().File();
  EXPECT_THAT(Complaint(bytes.Input("more", {1}).Bytes()), HasSubstr("has 2 inputs"));
  OnnxFile external = WithOneThing().File();
  EXPECT_THAT(Complaint(external.ExternalConstant("w", {3}).Bytes()),
              HasSubstr("weights in another file"));
  OnnxFile integers;
  integers.Input("images", {1, 3, 32, 32}, OnnxFile::kUint8).Node("Relu", {"images"}, "out");
  EXPECT_THAT(Complaint(integers.Bytes()), HasSubstr("float32"));
}

// The batch size may be variable. A variable image size is set to 640 pixels, which gives 8400
// cells.
TEST_F(OpenDetectorTest, ChoosesASizeWhenTheFileLeavesItOpen) {
  TinyNetwork network({1, 8400, 6}, 0);
  network.input = {-1, 3, -1, -1};
  network.At(8399, 4) = network.At(8399, 5) = 1;  // the last cell
  const auto detector = Open(network.Bytes());
  const cv::Mat image(640, 640, CV_8UC3, cv::Scalar::all(0));
  const std::vector<Detection> found = detector->Detect(image);
  ASSERT_EQ(found.size(), 1u);  // not decoded: at the cell's corner, 32 pixels wide
  EXPECT_EQ(found[0].box, cv::Rect2f(592, 592, 32, 32));
}

TEST_F(OpenDetectorTest, RefusesImagesItCannotRead) {
  const auto detector = Open(WithOneThing().Bytes());
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { detector->Detect(cv::Mat()); }),
              HasSubstr("empty"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { detector->Detect(cv::Mat(9, 9, CV_16UC1)); }),
              HasSubstr("channels of 8 bits"));
}

TEST_F(OpenDetectorTest, ChecksItsSettings) {
  EXPECT_EQ(ComplaintAbout(DetectorSettings{}), "");
  for (const float wrong : {-0.1f, 0.0f, 1.5f, std::nanf("")}) {
    EXPECT_THAT(ComplaintAbout(DetectorSettings{.min_score = wrong}), HasSubstr("min_score"));
    EXPECT_THAT(ComplaintAbout(DetectorSettings{.max_overlap = wrong}), HasSubstr("max_overlap"));
    EXPECT_THROW(OpenDetector("net.onnx", {.min_score = wrong}), Error);
  }
}

}  // namespace
}  // namespace alidade::open_detector_test
