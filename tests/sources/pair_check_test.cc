#include "alidade/run/sources/pair_check.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "support/rendered_frames.h"

namespace alidade::pair_check_test {
namespace {

// A rendered pair of cameras; `disturb` changes a frame, which may take images of others.
class Pairs : public FrameSource {
 public:
  using Disturb = std::function<void(Pairs&, SourceFrame&)>;
  Pairs(RenderedFrames& frames, int count, Disturb disturb)
      : frames_(frames), disturb_(std::move(disturb)) {
    info_.sensor = Sensor::kStereo;
    info_.camera = frames.camera();
    info_.frames = count;
  }
  // The camera of images turned by a quarter.
  void Turn() {
    Camera& camera = info_.camera;
    std::swap(camera.width, camera.height);
    std::swap(camera.fx, camera.fy);
    std::swap(camera.cx, camera.cy);
  }
  const SourceInfo& Info() const override { return info_; }
  bool Seek(int frames) override {
    next_ = frames;
    return true;
  }
  std::optional<SourceFrame> Next() override {
    if (next_ >= info_.frames) return std::nullopt;
    SourceFrame frame;
    frame.number = next_;
    frame.image = frames_.Frame(next_).image;
    frame.right = Right(next_++);
    disturb_(*this, frame);
    return frame;
  }
  cv::Mat Right(int number) { return frames_.Frame(std::clamp(number, 0, info_.frames - 1)).right; }

 private:
  RenderedFrames& frames_;
  Disturb disturb_;
  SourceInfo info_;
  int next_ = 0;
};

constexpr int kFrames = 60;

RenderedFrames& Room(const std::string& scene, uint64_t seed) {
  SynthSettings settings;
  settings.scene = scene;
  settings.seed = seed;
  settings.stereo = true;
  settings.width = 320;
  settings.height = 240;
  return FramesOf(settings);
}

PairVerdict VerdictOn(RenderedFrames& frames, const Pairs::Disturb& disturb) {
  Pairs pairs(frames, kFrames, disturb);
  return CheckPairs(pairs);
}

class PairCheck : public testing::TestWithParam<std::pair<const char*, uint64_t>> {
 protected:
  RenderedFrames& frames() const { return Room(GetParam().first, GetParam().second); }
};

TEST_P(PairCheck, SoundOnesAreSound) {
  const PairVerdict verdict = VerdictOn(frames(), [](Pairs&, SourceFrame&) {});
  EXPECT_EQ(verdict.fault, PairFault::kNone) << PairInWords(verdict);
  EXPECT_GT(verdict.pairs, 10);
}

TEST_P(PairCheck, SwappedImagesAreFound) {
  const PairVerdict verdict =
      VerdictOn(frames(), [](Pairs&, SourceFrame& frame) { std::swap(frame.image, frame.right); });
  EXPECT_EQ(verdict.fault, PairFault::kSwapped) << PairInWords(verdict);
}

TEST_P(PairCheck, DelaysAreFoundInFrames) {
  for (const int delay : {5, -3}) {
    const PairVerdict verdict = VerdictOn(frames(), [delay](Pairs& pairs, SourceFrame& frame) {
      frame.right = pairs.Right(frame.number - delay);
    });
    EXPECT_EQ(verdict.fault, PairFault::kDelayed) << delay << ": " << PairInWords(verdict);
    EXPECT_EQ(verdict.delay, delay);
  }
}

TEST_P(PairCheck, ACameraAboveTheOtherIsFound) {
  Pairs pairs(frames(), kFrames, [](Pairs&, SourceFrame& frame) {
    cv::Mat turned;
    cv::rotate(frame.image, turned, cv::ROTATE_90_CLOCKWISE);
    frame.image = turned;
    cv::rotate(frame.right, frame.right, cv::ROTATE_90_CLOCKWISE);
  });
  pairs.Turn();
  const PairVerdict verdict = CheckPairs(pairs);
  EXPECT_EQ(verdict.fault, PairFault::kStacked) << PairInWords(verdict);
}

TEST_P(PairCheck, RowsThatDoNotCorrespondAreFound) {
  const PairVerdict verdict = VerdictOn(frames(), [](Pairs&, SourceFrame& frame) {
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 9);
    cv::Mat shifted;  // the images are shared by all tests
    cv::warpAffine(frame.right, shifted, shift, frame.right.size());
    frame.right = shifted;
  });
  EXPECT_EQ(verdict.fault, PairFault::kRowsOff) << PairInWords(verdict);
  EXPECT_NEAR(verdict.rows, 9, 1);
}

// A street at 8 m/s: almost no disparity, rows that agree for a camera that moves forward.
TEST(PairCheckFarAway, IsSoundAndADifferenceOfRowsIsFound) {
  RenderedFrames& street = Room("street", 12);
  EXPECT_EQ(VerdictOn(street, [](Pairs&, SourceFrame&) {}).fault, PairFault::kNone);
  const PairVerdict moved = VerdictOn(street, [](Pairs&, SourceFrame& frame) {
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, 9);
    cv::Mat shifted;  // the images are shared by all tests
    cv::warpAffine(frame.right, shifted, shift, frame.right.size());
    frame.right = shifted;
  });
  EXPECT_TRUE(moved.fault == PairFault::kRowsOff || moved.fault == PairFault::kStacked)
      << PairInWords(moved);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PairCheck,
                         testing::Values(std::pair{"room", uint64_t{3}},
                                         std::pair{"corridor", uint64_t{2}},
                                         std::pair{"hall", uint64_t{11}},
                                         std::pair{"loop", uint64_t{13}}));

}  // namespace
}  // namespace alidade::pair_check_test
