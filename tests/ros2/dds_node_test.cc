// The DDS module against another vendor's participant.
#include <chrono>
#include <thread>

#include "alidade/io/dds/dds_module.h"
#include "alidade/io/ros/live/domain.h"
#include "ros2/camera_driver.h"

namespace alidade {
namespace {

// Within 10 s.
template <typename Condition>
bool Comes(const Condition& condition) {
  for (int i = 0; i < 1000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class DdsModule : public testing::Test {
 protected:
  int Advertise(const std::string& topic, const std::string& type, DdsQuality quality) {
    std::string problem;
    const int publication = node_->Advertise(topic, type, quality, &problem);
    EXPECT_GE(publication, 0) << problem;
    return publication;
  }

  const int domain_ = UseOwnDomain();
  FastPeer peer_{domain_};
  // Two of one process share the domain.
  std::unique_ptr<DdsNode> other_ = JoinDomain(DomainFromEnvironment());
  std::unique_ptr<DdsNode> node_ = JoinDomain(DomainFromEnvironment());
};

TEST_F(DdsModule, PublishesTheBytesItIsGiven) {
  std::mutex mutex;
  std::vector<std::string> heard;
  peer_.Subscribe("rt/tf", "tf2_msgs::msg::dds_::TFMessage_", FastPeer::Quality::kReliable,
                  [&](std::string bytes) {
                    const std::lock_guard<std::mutex> lock(mutex);
                    heard.push_back(std::move(bytes));
                  });
  const int tf = Advertise("/tf", "tf2_msgs/TFMessage", DdsQuality::kReliable);
  ASSERT_TRUE(Comes([&] { return node_->Listeners(tf) == 1; }));
  std::vector<std::string> sent;
  for (const char* name : {"a", "ab", "abc", "abcd"}) {
    sent.push_back(EncodeTransforms({{RosTime::FromSeconds(1.5), "map", name, Se3()}}));
    EXPECT_TRUE(node_->Publish(tf, sent.back()));
  }
  const auto count = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return heard.size();
  };
  EXPECT_TRUE(Comes([&] { return count() == sent.size(); }));
  for (size_t i = 0; i < count(); ++i)
    EXPECT_EQ(heard[i].substr(4, sent[i].size() - 4), sent[i].substr(4));  // without CDR's header
}

TEST_F(DdsModule, RefusesBytesThatAreNotOfTheType) {
  const int tf = Advertise("/tf", "tf2_msgs/TFMessage", DdsQuality::kReliable);
  const std::string good = EncodeTransforms({{RosTime::FromSeconds(1.5), "map", "odom", Se3()}});
  EXPECT_TRUE(node_->Publish(tf, good));
  EXPECT_FALSE(node_->Publish(tf, good.substr(0, good.size() - 8)));
  EXPECT_FALSE(node_->Publish(tf, ""));
  EXPECT_FALSE(node_->Publish(tf, std::string("\0\1\0\0\377\377\377\377", 8)));
  std::string problem;
  EXPECT_EQ(node_->Advertise("/x", "my_msgs/Unknown", DdsQuality::kReliable, &problem), -1);
  EXPECT_NE(problem.find("my_msgs/Unknown"), std::string::npos);
}

TEST_F(DdsModule, TellsWhoseQualityDoesNotMatch) {
  peer_.Subscribe("rt/alidade/pose", "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_",
                  FastPeer::Quality::kLatched, [](std::string) {});
  Advertise("/alidade/pose", "geometry_msgs/PoseWithCovarianceStamped", DdsQuality::kReliable);
  std::vector<std::string> news;
  EXPECT_TRUE(Comes([&] {
    for (std::string& sentence : node_->News()) news.push_back(std::move(sentence));
    return !news.empty();
  }));
  ASSERT_EQ(news.size(), 1u);
  EXPECT_NE(news.front().find("/alidade/pose"), std::string::npos);
  EXPECT_NE(news.front().find("durability"), std::string::npos);
  EXPECT_TRUE(node_->News().empty());
}

TEST_F(DdsModule, LateSubscribersGetWhatIsLatched) {
  const int fixed = Advertise("/tf_static", "tf2_msgs/TFMessage", DdsQuality::kLatched);
  EXPECT_TRUE(node_->Publish(fixed, EncodeTransforms({{{}, "map", "map_optical", Se3()}})));
  std::atomic<int> heard{0};
  peer_.Subscribe("rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", FastPeer::Quality::kLatched,
                  [&](std::string) { ++heard; });
  EXPECT_TRUE(Comes([&] { return heard == 1; }));
}

}  // namespace
}  // namespace alidade
