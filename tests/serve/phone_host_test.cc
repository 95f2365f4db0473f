// The computer that works for phones' pages (alidade phone --connected), without a network.
#include "phone_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>

#include "alidade/io/files/image_codec.h"
#include "support/temp_folder.h"
#include "support/walked_room.h"

namespace alidade::phone_host_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kPage = "0123456789abcdef0123456789abcdef";

// One page: joins, sends images one after the other, and leaves when destroyed.
class Page {
 public:
  Page(PhoneHost& host, const std::string& session, const Camera& camera) {
    const std::string hello = "{\"session\": \"" + session +
                              "\", \"width\": " + std::to_string(camera.width) +
                              ", \"height\": " + std::to_string(camera.height) + ", \"fov\": 60}";
    const auto hear = [this](const std::vector<FrameMessage>& messages, bool) {
      const std::lock_guard lock(mutex_);
      for (const FrameMessage& message : messages) {
        if (!message.text) continue;
        last_ = message.bytes;
        if (message.bytes.find("\"frame\"") != std::string::npos) ++answers_;
      }
      answered_.notify_all();
    };
    seat_ = host.Join(hello, hear, &problem_);
  }

  void Send(const WalkedRoom& room, int from, int until) {
    for (int i = from; i < until; ++i) {
      const double time = i / 30.0;
      const auto number = static_cast<uint32_t>(i);
      std::string bytes(16, '\0');
      std::memcpy(bytes.data(), &number, sizeof(number));
      std::memcpy(bytes.data() + 8, &time, sizeof(time));
      std::unique_lock lock(mutex_);
      const int before = answers_;
      lock.unlock();
      seat_->Take(bytes + EncodeJpeg(room.frames[static_cast<size_t>(i)].image, 95));
      lock.lock();
      answered_.wait(lock, [&] { return answers_ > before; });
    }
  }

  std::string Last() {
    const std::lock_guard lock(mutex_);
    return last_;
  }
  const std::string& problem() const { return problem_; }

 private:
  std::string problem_;
  std::mutex mutex_;
  std::condition_variable answered_;
  std::string last_;
  int answers_ = 0;
  std::unique_ptr<FrameSeat> seat_;  // destroyed first: nothing is told afterwards
};

std::string Read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> Names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

// Waits until the session's last file is there.
bool IsWritten(const fs::path& folder) {
  for (int i = 0; i < 6000 && !fs::exists(folder / "landmarks.ply"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return fs::exists(folder / "landmarks.ply");
}

class PhoneHostTest : public ::testing::Test {
 protected:
  PhoneHostSettings Settings() const {
    PhoneHostSettings settings;
    settings.out = out_;
    settings.keep_seconds = 0;  // instead of five minutes
    return settings;
  }

  const WalkedRoom room_ = WalkRoom({.actors = 0, .frames = 60});
  const TempFolder folder_;
  const std::string out_ = folder_ / "maps";
};

TEST_F(PhoneHostTest, APageThatComesBackTooLateDoesNotOverwriteItsFirstMap) {
  std::string first;
  {
    PhoneHost host(Settings());
    Page(host, kPage, room_.camera).Send(room_, 0, 60);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    {
      Page back(host, kPage, room_.camera);
      EXPECT_THAT(back.Last(), HasSubstr("\"resumed\":false"));
      ASSERT_TRUE(IsWritten(fs::path(out_) / "session-1"));
      first = Read(fs::path(out_) / "session-1" / "trajectory.txt");
      EXPECT_NE(first, "");
      back.Send(room_, 0, 30);
    }
  }
  EXPECT_THAT(Names(out_), ::testing::ElementsAre("session-1", "session-2"));
  EXPECT_EQ(Read(fs::path(out_) / "session-1" / "trajectory.txt"), first);
  EXPECT_NE(Read(fs::path(out_) / "session-2" / "map.alidade"), "");
}

TEST_F(PhoneHostTest, AnotherRunOfTheProgramKeepsTheResultsOfTheOneBefore) {
  fs::create_directories(fs::path(out_) / "session-1");
  std::ofstream(fs::path(out_) / "session-1" / "map.alidade") << "of yesterday";
  {
    PhoneHost host(Settings());
    Page(host, kPage, room_.camera).Send(room_, 0, 60);
  }
  EXPECT_THAT(Names(out_), ::testing::ElementsAre("session-1", "session-2"));
  EXPECT_EQ(Read(fs::path(out_) / "session-1" / "map.alidade"), "of yesterday");
}

TEST_F(PhoneHostTest, WhatAPageLeftIsWrittenWithoutWaitingForAnotherPage) {
  PhoneHost host(Settings());
  {
    Page page(host, kPage, room_.camera);
    page.Send(room_, 0, 60);
    host.EndAbandoned();
    EXPECT_THAT(Names(out_), IsEmpty());  // the page is there
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  host.EndAbandoned();
  EXPECT_TRUE(IsWritten(fs::path(out_) / "session-1"));
  EXPECT_THAT(Names(out_), ::testing::ElementsAre("session-1"));
}

// Finishing takes a good part of a second, joining none of it.
TEST_F(PhoneHostTest, NoPageWaitsWhileTheMapOfAnotherIsFinished) {
  PhoneHostSettings settings = Settings();
  settings.max_sessions = 2;
  PhoneHost host(settings);
  Page(host, kPage, room_.camera).Send(room_, 0, 60);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  Page other(host, "f" + std::string(31, '0'), room_.camera);
  EXPECT_FALSE(fs::exists(fs::path(out_) / "session-1" / "landmarks.ply"))
      << "the page waited until the other's map was written";
  EXPECT_EQ(other.problem(), "");
  other.Send(room_, 0, 2);
  EXPECT_TRUE(IsWritten(fs::path(out_) / "session-1"));
}

TEST_F(PhoneHostTest, ASessionWithoutAMapLeavesNoFolder) {
  {
    PhoneHost host(Settings());
    Page(host, kPage, room_.camera).Send(room_, 0, 1);
  }
  EXPECT_THAT(Names(out_), IsEmpty());
}

}  // namespace
}  // namespace alidade::phone_host_test
