#include "alidade/io/colmap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <sstream>

#include "support/expect_error.h"

namespace alidade::colmap_test {
namespace {

ColmapModel SomeModel() {
  ColmapModel model;
  model.camera = Camera::FromFieldOfView(640, 480, 90);
  model.camera.distortion = {0.1, -0.05, 0.001, 0.002, 0};
  Se3 turned;  // a quarter turn about z
  turned.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  turned.t = {1, 2, 3};
  model.images = {{"0.000000.png", {}, {{{0, 0}, 1}, {{10.25, 20.5}}}},
                  {"0.100000.png", turned, {}},
                  {"0.200000.png", turned, {{{639, 479}, 1}}}};
  model.points.resize(2);
  model.points[0].p_world = {-1, 0.5, 1e-3};
  model.points[1] = {{0.1, 0.2, 4}, {255, 0, 7}, 0.75, {{0, 0}, {2, 0}}};
  return model;
}

std::vector<std::string> Lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] != '#') lines.push_back(line);
  }
  return lines;
}

std::vector<double> Numbers(const std::string& line) {
  std::istringstream in(line);
  std::vector<double> numbers;
  for (double number = 0; in >> number;) numbers.push_back(number);
  return numbers;
}

// As specified by colmap.github.io/format.html.
TEST(Colmap, TextHoldsTheModelWithTheOriginInTheCorner) {
  const auto files = EncodeColmapText(SomeModel());
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].name, "cameras.txt");
  EXPECT_EQ(files[1].name, "images.txt");
  EXPECT_EQ(files[2].name, "points3D.txt");

  const auto cameras = Lines(files[0].bytes);
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0].substr(0, 17), "1 OPENCV 640 480 ");
  const auto parameters = Numbers(cameras[0].substr(17));  // fx fy cx cy k1 k2 p1 p2
  ASSERT_EQ(parameters.size(), 8u);
  EXPECT_NEAR(parameters[0], 320, 1e-9);
  EXPECT_NEAR(parameters[2], 320, 1e-9);  // the middle of 640 columns, measured from the border
  EXPECT_NEAR(parameters[3], 240, 1e-9);
  EXPECT_EQ(parameters[4], 0.1);
  EXPECT_EQ(parameters[7], 0.002);

  const auto images = Lines(files[1].bytes);
  ASSERT_EQ(images.size(), 6u);
  EXPECT_EQ(images[0], "1 1 0 0 0 0 0 0 1 0.000000.png");
  EXPECT_EQ(images[1], "0.5 0.5 2 10.75 21 -1");
  EXPECT_EQ(images[3], "");
  EXPECT_EQ(images[5], "639.5 479.5 2");
  const auto pose = Numbers(images[2].substr(0, images[2].find(" 1 0.1")));
  ASSERT_EQ(pose.size(), 8u);
  EXPECT_NEAR(pose[1], std::sqrt(0.5), 1e-12);  // qw
  EXPECT_NEAR(pose[4], std::sqrt(0.5), 1e-12);  // qz
  EXPECT_EQ(pose[7], 3);

  const auto points = Lines(files[2].bytes);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(Numbers(points[0]),
            (std::vector<double>{1, -1, 0.5, 1e-3, 128, 128, 128, -1}));  // gray, error unknown
  EXPECT_EQ(Numbers(points[1]), (std::vector<double>{2, 0.1, 0.2, 4, 255, 0, 7, 0.75, 1, 0, 3, 0}));
}

TEST(Colmap, TheCameraIsTheSimplestThatHoldsItsDistortion) {
  ColmapModel model = SomeModel();
  model.camera.distortion = {0.1, -0.05, 0.001, 0.002, 0.01};
  const std::string full = Lines(EncodeColmapText(model)[0].bytes).at(0);
  EXPECT_EQ(full.substr(0, 23), "1 FULL_OPENCV 640 480 3");
  const auto parameters = Numbers(full.substr(22));
  ASSERT_EQ(parameters.size(), 12u);
  EXPECT_EQ(parameters[8], 0.01);
  EXPECT_EQ(parameters[9], 0);
  model.camera.distortion = {};
  const std::string plain = Lines(EncodeColmapText(model)[0].bytes).at(0);
  EXPECT_EQ(plain.substr(0, 18), "1 PINHOLE 640 480 ");
  EXPECT_EQ(Numbers(plain.substr(18)).size(), 4u);
}

// Reads numbers from the beginning of a string; the test machines are little endian.
class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  template <typename T>
  double Next() {
    T value{};
    if (at_ + sizeof(T) > bytes_.size()) ADD_FAILURE() << "too short";
    std::memcpy(&value, bytes_.data() + at_, std::min(sizeof(T), bytes_.size() - at_));
    at_ += sizeof(T);
    return static_cast<double>(value);
  }
  std::vector<double> Doubles(int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(Next<double>());
    return values;
  }
  std::string Word() {
    const std::string word = bytes_.c_str() + at_;
    at_ += word.size() + 1;
    return word;
  }
  bool AtEnd() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  size_t at_ = 0;
};

TEST(Colmap, BinaryHoldsTheSameNumbers) {
  const auto files = EncodeColmapBinary(SomeModel());
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].name, "cameras.bin");
  Reader cameras(files[0].bytes);
  EXPECT_EQ(cameras.Next<uint64_t>(), 1);
  EXPECT_EQ(cameras.Next<uint32_t>(), 1);
  EXPECT_EQ(cameras.Next<int32_t>(), 4);  // OPENCV
  EXPECT_EQ(cameras.Next<uint64_t>(), 640);
  EXPECT_EQ(cameras.Next<uint64_t>(), 480);
  EXPECT_EQ(cameras.Doubles(8)[5], -0.05);
  EXPECT_TRUE(cameras.AtEnd());

  EXPECT_EQ(files[1].name, "images.bin");
  Reader images(files[1].bytes);
  EXPECT_EQ(images.Next<uint64_t>(), 3);
  const std::vector<std::vector<double>> keypoints = {
      {0.5, 0.5, 2, 10.75, 21, static_cast<double>(~uint64_t{0})}, {}, {639.5, 479.5, 2}};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(images.Next<uint32_t>(), i + 1);
    const auto pose = images.Doubles(7);
    EXPECT_NEAR(pose[0], i == 0 ? 1 : std::sqrt(0.5), 1e-12);
    EXPECT_EQ(pose[6], i == 0 ? 0 : 3);
    EXPECT_EQ(images.Next<uint32_t>(), 1);
    EXPECT_EQ(images.Word(), "0." + std::to_string(i) + "00000.png");
    const double count = images.Next<uint64_t>();
    ASSERT_EQ(count, static_cast<double>(keypoints[i].size() / 3));
    for (size_t k = 0; k < keypoints[i].size(); k += 3) {
      EXPECT_EQ(images.Doubles(2), (std::vector<double>{keypoints[i][k], keypoints[i][k + 1]}));
      EXPECT_EQ(images.Next<uint64_t>(), keypoints[i][k + 2]);
    }
  }
  EXPECT_TRUE(images.AtEnd());

  EXPECT_EQ(files[2].name, "points3D.bin");
  Reader points(files[2].bytes);
  EXPECT_EQ(points.Next<uint64_t>(), 2);
  EXPECT_EQ(points.Next<uint64_t>(), 1);
  EXPECT_EQ(points.Doubles(3), (std::vector<double>{-1, 0.5, 1e-3}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(points.Next<uint8_t>(), 128);
  EXPECT_EQ(points.Next<double>(), -1);
  EXPECT_EQ(points.Next<uint64_t>(), 0);
  EXPECT_EQ(points.Next<uint64_t>(), 2);
  EXPECT_EQ(points.Doubles(3)[2], 4);
  EXPECT_EQ(points.Next<uint8_t>(), 255);
  EXPECT_EQ(points.Next<uint8_t>(), 0);
  EXPECT_EQ(points.Next<uint8_t>(), 7);
  EXPECT_EQ(points.Next<double>(), 0.75);
  EXPECT_EQ(points.Next<uint64_t>(), 2);
  for (double part : {1, 0, 3, 0}) EXPECT_EQ(points.Next<uint32_t>(), part);
  EXPECT_TRUE(points.AtEnd());
}

TEST(Colmap, RefusesWhatLeadsNowhere) {
  const auto refused = [](void (*spoil)(ColmapModel&)) {
    ColmapModel model = SomeModel();
    spoil(model);
    MessageOf(ErrorKind::kUsage, [&] { EncodeColmapText(model); });
    MessageOf(ErrorKind::kUsage, [&] { EncodeColmapBinary(model); });
  };
  refused([](ColmapModel& m) { m.images[0].keypoints[0].point = 2; });
  refused([](ColmapModel& m) { m.points[1].track[0].image = 3; });
  refused([](ColmapModel& m) { m.points[1].track[0].keypoint = -1; });
  refused([](ColmapModel& m) { m.images[0].name = "two words.png"; });
}

}  // namespace
}  // namespace alidade::colmap_test
