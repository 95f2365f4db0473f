// When results of the detector arrive, and that the tracker does not wait for them.
#include "alidade/system/workers/detection_feed.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "alidade/detect/late_detector.h"
#include "support/expect_error.h"
#include "support/scripted_detector.h"

namespace alidade::detection_feed_test {
namespace {

using testing::HasSubstr;

// An image whose gray level is the number of its frame.
cv::Mat Picture(int number) { return cv::Mat(8, 8, CV_8U, cv::Scalar(number)); }

// One detection, whose class is the number of the image's frame.
std::vector<Detection> NumberOf(const cv::Mat& image) { return {{image.at<uint8_t>(0, 0), 1, {}}}; }

class InlineFeed : public testing::Test {
 protected:
  // Numbers of the frames whose results are returned at each of `frames` frames; -1: no result.
  std::vector<int> Play(int frames, uint64_t seed = 1) {
    shown_.clear();
    const auto detector = std::make_shared<ScriptedDetector>([&](const cv::Mat& image) {
      shown_.push_back(image.at<uint8_t>(0, 0));
      return NumberOf(image);
    });
    DetectionFeed feed(detector, settings_, false, seed);
    std::vector<int> answers;
    for (int number = 0; number < frames; ++number) {
      feed.Offer(number, Picture(number));
      const auto answer = feed.Take(number);
      answers.push_back(answer ? answer->number : -1);
      if (!answer) continue;
      EXPECT_EQ(answer->detections.size(), 1u);
      EXPECT_EQ(answer->detections[0].class_id, answer->number);
      EXPECT_FALSE(feed.Take(number).has_value());  // each result once
    }
    EXPECT_EQ(feed.milliseconds().All().size(), shown_.size());
    return answers;
  }
  DynamicsSettings settings_;
  std::vector<int> shown_;
};

TEST_F(InlineFeed, EverySoManyFramesOneIsAnsweredSoManyFramesLater) {
  for (int every : {1, 3, 6}) {
    for (int late : {0, 1, 5, 10}) {
      settings_.detector_every_frames = every;
      settings_.detector_latency_frames = late;
      const std::vector<int> answers = Play(40);
      for (int number = 0; number < 40; ++number) {
        const int of = number - late;
        EXPECT_EQ(answers[number], of >= 0 && of % every == 0 ? of : -1);
      }
      for (size_t i = 0; i < shown_.size(); ++i) EXPECT_EQ(shown_[i], static_cast<int>(i) * every);
    }
  }
}

// As when a recording continues in a saved map.
TEST_F(InlineFeed, TheFirstFrameIsShownWhateverItsNumber) {
  settings_.detector_every_frames = 6;
  settings_.detector_latency_frames = 2;
  std::vector<int> shown;
  const auto detector = std::make_shared<ScriptedDetector>([&](const cv::Mat& image) {
    shown.push_back(image.at<uint8_t>(0, 0));
    return NumberOf(image);
  });
  DetectionFeed feed(detector, settings_, false, 1);
  for (int number = 100; number < 115; ++number) {
    feed.Offer(number, Picture(number));
    EXPECT_EQ(feed.Take(number).has_value(), (number - 102) % 6 == 0) << number;
  }
  EXPECT_EQ(shown, (std::vector<int>{100, 106, 112}));
}

TEST_F(InlineFeed, AnswersThatAreThrownAwayAreTheSameOnesForTheSameSeed) {
  settings_.detector_every_frames = 1;
  settings_.detector_latency_frames = 0;
  settings_.drop_detections = 0.3;
  const std::vector<int> answers = Play(200);
  EXPECT_EQ(Play(200), answers);
  EXPECT_NE(Play(200, 2), answers);
  const auto dropped = std::count(answers.begin(), answers.end(), -1);
  EXPECT_NEAR(static_cast<double>(dropped), 60, 20);  // 20: three standard deviations
  settings_.drop_detections = 1;
  EXPECT_EQ(Play(50), std::vector<int>(50, -1));
}

TEST_F(InlineFeed, OfSeveralThatAreDueTheNewestIsHandedOver) {
  settings_.detector_every_frames = 1;
  settings_.detector_latency_frames = 2;
  DetectionFeed feed(std::make_shared<ScriptedDetector>(NumberOf), settings_, false, 1);
  for (int number = 0; number < 10; ++number) feed.Offer(number, Picture(number));
  EXPECT_EQ(feed.Take(9)->number, 7);
  EXPECT_FALSE(feed.Take(9).has_value());
  EXPECT_EQ(feed.Take(11)->number, 9);
}

TEST_F(InlineFeed, ADetectorThatFailsIsToldOfOnceAndNotAskedAgain) {
  settings_.detector_every_frames = 1;
  settings_.detector_latency_frames = 0;
  int asked = 0;
  const auto detector = std::make_shared<ScriptedDetector>([&](const cv::Mat& image) {
    if (++asked == 3) throw Error(ErrorKind::kInput, "its answers are not numbers");
    return NumberOf(image);
  });
  const WarningCatcher warnings;
  DetectionFeed feed(detector, settings_, false, 1);
  int answers = 0;
  for (int number = 0; number < 10; ++number) {
    feed.Offer(number, Picture(number));
    answers += feed.Take(number).has_value();
  }
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(answers, 2);
  EXPECT_THAT(warnings.text(), HasSubstr("its answers are not numbers"));
  EXPECT_THAT(warnings.text(), HasSubstr("frame 2"));
  EXPECT_EQ(std::count(warnings.text().begin(), warnings.text().end(), '\n'), 1);
}

TEST_F(InlineFeed, OfTooManyTheBestAreHandedOver) {
  settings_.detector_every_frames = 1;
  settings_.detector_latency_frames = 0;
  const auto detector = std::make_shared<ScriptedDetector>([&](const cv::Mat&) {
    std::vector<Detection> many(100000, Detection{0, 0.5f, {1, 2, 3, 4}});
    many.back().score = 0.9f;
    return many;
  });
  const WarningCatcher warnings;
  DetectionFeed feed(detector, settings_, false, 1);
  for (int number = 0; number < 3; ++number) {
    feed.Offer(number, Picture(number));
    const auto answer = feed.Take(number);
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ(answer->detections.size(), static_cast<size_t>(kMostDetections));
    EXPECT_EQ(answer->detections[0].score, 0.9f);
  }
  EXPECT_THAT(warnings.text(), HasSubstr("100000 objects"));
  EXPECT_EQ(std::count(warnings.text().begin(), warnings.text().end(), '\n'), 1);
}

TEST_F(InlineFeed, WithoutADetectorThereAreNoAnswers) {
  for (bool threaded : {false, true}) {
    DetectionFeed feed(nullptr, settings_, threaded, 1);
    for (int number = 0; number < 10; ++number) {
      feed.Offer(number, Picture(number));
      EXPECT_FALSE(feed.Take(number).has_value());
    }
    EXPECT_TRUE(feed.milliseconds().All().empty());
  }
}

// A detector that waits in Detect() until Let() allows it to return.
class Gate {
 public:
  std::vector<Detection> Detect(const cv::Mat& image) {
    std::unique_lock<std::mutex> lock(mutex_);
    shown_.push_back(image.at<uint8_t>(0, 0));
    changed_.notify_all();
    changed_.wait(lock, [&] { return allowed_ >= shown_.size(); });
    return NumberOf(image);
  }
  void Let(size_t answers) {
    std::lock_guard<std::mutex> lock(mutex_);
    allowed_ += answers;
    changed_.notify_all();
  }
  // Waits until it was given `count` frames; returns the numbers of all of them.
  std::vector<int> WaitForShown(size_t count) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return shown_.size() >= count; });
    return shown_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<int> shown_;
  size_t allowed_ = 0;
};

class ThreadedFeed : public testing::Test {
 protected:
  ThreadedFeed() { settings_.detector_rest = 0; }
  std::unique_ptr<DetectionFeed> Feed() {
    return std::make_unique<DetectionFeed>(
        std::make_shared<ScriptedDetector>(
            [this](const cv::Mat& image) { return gate_.Detect(image); }),
        settings_, true, 1);
  }
  // Waits for a result; if none comes, the time limit of the test ends it.
  static FrameDetections WaitForAnswer(DetectionFeed& feed, int number) {
    for (;;) {
      if (auto answer = feed.Take(number)) return *answer;
      std::this_thread::yield();
    }
  }
  Gate gate_;
  DynamicsSettings settings_;
};

TEST_F(ThreadedFeed, TheNewestFrameWinsAndNobodyWaitsForASlowDetector) {
  const auto feed = Feed();
  feed->Offer(0, Picture(0));
  gate_.WaitForShown(1);
  for (int number = 1; number < 100; ++number) {  // the detector is still busy with frame 0
    feed->Offer(number, Picture(number));
    EXPECT_FALSE(feed->Take(number).has_value());
  }
  gate_.Let(1);
  EXPECT_EQ(gate_.WaitForShown(2), (std::vector<int>{0, 99}));
  EXPECT_EQ(WaitForAnswer(*feed, 100).number, 0);
  gate_.Let(1);
  const FrameDetections answer = WaitForAnswer(*feed, 100);
  EXPECT_EQ(answer.number, 99);
  EXPECT_EQ(answer.detections[0].class_id, 99);
  EXPECT_EQ(feed->milliseconds().All().size(), 2u);
}

TEST_F(ThreadedFeed, ThePictureIsTheDetectorsOwn) {
  const auto feed = Feed();
  feed->Offer(0, Picture(0));
  gate_.WaitForShown(1);
  cv::Mat picture = Picture(5);
  feed->Offer(5, picture);
  picture.setTo(200);  // as if the next frame were read into it
  gate_.Let(2);
  EXPECT_EQ(gate_.WaitForShown(2).back(), 5);
}

TEST_F(ThreadedFeed, NothingQueuesUp) {
  const auto feed = Feed();
  gate_.Let(1000);
  for (int number = 0; number < 200; ++number) feed->Offer(number, Picture(number));
  while (WaitForAnswer(*feed, 200).number != 199) std::this_thread::yield();
  EXPECT_FALSE(feed->Take(200).has_value());
}

TEST_F(ThreadedFeed, ADetectorThatFailsIsToldOfOnceAndNotAskedAgain) {
  const WarningCatcher warnings;
  std::atomic<int> asked = 0;
  {
    DetectionFeed feed(
        std::make_shared<ScriptedDetector>([&](const cv::Mat&) -> std::vector<Detection> {
          ++asked;
          throw std::runtime_error("out of memory");
        }),
        settings_, true, 1);
    feed.Offer(0, Picture(0));
    while (asked == 0) std::this_thread::yield();
    for (int number = 1; number < 50; ++number) {
      feed.Offer(number, Picture(number));
      EXPECT_FALSE(feed.Take(number).has_value());
    }
  }
  EXPECT_EQ(asked, 1);
  EXPECT_THAT(warnings.text(), HasSubstr("out of memory"));
  EXPECT_EQ(std::count(warnings.text().begin(), warnings.text().end(), '\n'), 1);
}

TEST_F(ThreadedFeed, EndsWhileFramesAreOfferedAndWhileItRests) {
  settings_.detector_rest = 100;
  gate_.Let(1000);
  for (int i = 0; i < 20; ++i) {
    const auto feed = Feed();
    for (int number = 0; number < i; ++number) feed->Offer(number, Picture(number));
  }
}

TEST(LateFeed, AnswersComeFromElsewhereAndNoneIsOfAFrameToCome) {
  for (const bool threaded : {false, true}) {
    const auto detector = std::make_shared<LateDetector>(std::vector<std::string>{"person"});
    DetectionFeed feed(detector, {}, threaded, 1);
    feed.Offer(0, Picture(0));
    EXPECT_FALSE(feed.Take(0).has_value());
    detector->Bring({0, {}});
    feed.Offer(5, Picture(5));
    EXPECT_EQ(feed.Take(5)->number, 0);
    EXPECT_FALSE(feed.Take(6).has_value());
    detector->Bring({9, {}});
    EXPECT_FALSE(feed.Take(7).has_value());
    EXPECT_EQ(feed.failure(), nullptr);  // the detector was never called
    EXPECT_TRUE(feed.milliseconds().All().empty());
  }
}

}  // namespace
}  // namespace alidade::detection_feed_test
