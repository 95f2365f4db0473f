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
  std::unique_ptr<DdsNode> other_ = JoinDomain(DomainFromEnvironment(), "other");
  std::unique_ptr<DdsNode> node_ = JoinDomain(DomainFromEnvironment(), "node");
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

// How nodes of ROS 2 learn of each other. Read here by the interface definitions of rmw_dds_common.
class NodeList : public DdsModule {
 protected:
  static constexpr char kTopic[] = "ros_discovery_info";
  static constexpr char kType[] = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

  struct Told {
    std::string gid, space, name;
    std::vector<std::string> readers, writers;  // gids
  };

  static Told Parse(const std::string& message, size_t gid_bytes) {
    Told told;
    size_t at = 4;  // after CDR's header
    const auto number = [&] {
      at += (4 - at % 4) % 4;
      uint32_t value = 0;
      if (at + 4 <= message.size()) std::memcpy(&value, message.data() + at, 4);
      at += 4;
      return value;
    };
    const auto bytes = [&](size_t size) {
      at += size;
      return at <= message.size() ? message.substr(at - size, size) : std::string();
    };
    const auto text = [&] { return bytes(number()).c_str() + std::string(); };
    const auto gids = [&] {
      std::vector<std::string> all(std::min<size_t>(number(), 100));
      for (std::string& gid : all) gid = bytes(gid_bytes);
      return all;
    };
    told.gid = bytes(gid_bytes);
    EXPECT_EQ(number(), 1u);  // node
    told.space = text();
    told.name = text();
    told.readers = gids();
    told.writers = gids();
    EXPECT_GE(at + 3, message.size());
    EXPECT_LE(at, message.size());
    return told;
  }

  // The newest message of node_ once it has told `writers` of them; the other participant is
  // silent.
  Told Hear(size_t gid_bytes, size_t writers) {
    std::string last;
    EXPECT_TRUE(Comes([&] {
      node_->Take(0.01);
      const std::lock_guard<std::mutex> lock(mutex_);
      if (heard_.empty()) return false;
      last = heard_.back();
      return Parse(last, gid_bytes).writers.size() == writers;
    }));
    return Parse(last, gid_bytes);
  }

  void Listen() {
    peer_.Subscribe(kTopic, kType, FastPeer::Quality::kLatched, [this](std::string bytes) {
      const std::lock_guard<std::mutex> lock(mutex_);
      heard_.push_back(std::move(bytes));
    });
  }

  void ExpectNodeWithEndpoints(size_t gid_bytes) {
    Advertise("/tf", "tf2_msgs/TFMessage", DdsQuality::kReliable);
    std::string problem;
    EXPECT_GE(
        node_->Subscribe("/alidade/save", "std_msgs/Empty", DdsQuality::kReliable, 1, &problem), 0);
    const Told one = Hear(gid_bytes, 1);
    EXPECT_EQ(one.space, "/");
    EXPECT_EQ(one.name, "node");
    ASSERT_EQ(one.readers.size(), 1u);
    // A GUID is 12 bytes of the participant and 4 of the entity; 1c1 is the participant itself, and
    // the last byte of an endpoint tells its kind (DDSI-RTPS 9.3.1: 3 or 4, without a key).
    EXPECT_EQ(one.gid.substr(12, 4), std::string("\0\0\1\xc1", 4));
    EXPECT_EQ(one.gid.substr(16), std::string(gid_bytes - 16, '\0'));
    EXPECT_EQ(one.writers[0].substr(0, 12), one.gid.substr(0, 12));
    EXPECT_EQ(one.readers[0].substr(0, 12), one.gid.substr(0, 12));
    EXPECT_EQ(one.writers[0][15], 3);
    EXPECT_EQ(one.readers[0][15], 4);
    Advertise("/tf_static", "tf2_msgs/TFMessage", DdsQuality::kLatched);
    EXPECT_EQ(Hear(gid_bytes, 2).writers[0], one.writers[0]);
  }

  std::mutex mutex_;
  std::vector<std::string> heard_;  // guarded by mutex_
};

TEST_F(NodeList, ANodeSinceIronIsToldIdsOf16Bytes) {
  unsetenv("ROS_DISTRO");
  peer_.Advertise(kTopic, kType, FastPeer::Quality::kLatched, "typehash=RIHS01_0a;");
  Listen();
  ExpectNodeWithEndpoints(16);
}

TEST_F(NodeList, ANodeUntilHumbleIsToldIdsOf24Bytes) {
  unsetenv("ROS_DISTRO");
  peer_.Advertise(kTopic, kType, FastPeer::Quality::kLatched);
  Listen();
  ExpectNodeWithEndpoints(24);
}

TEST_F(NodeList, TheNamedDistributionCounts) {
  setenv("ROS_DISTRO", "humble", 1);
  Listen();
  ExpectNodeWithEndpoints(24);
  unsetenv("ROS_DISTRO");
}

// The other layout might stop their discovery.
TEST_F(NodeList, NothingIsToldBeforeANodeOfRosIsSeen) {
  unsetenv("ROS_DISTRO");
  Listen();
  Advertise("/tf", "tf2_msgs/TFMessage", DdsQuality::kReliable);
  for (int i = 0; i < 25; ++i) {
    node_->Take(0.1);
    other_->Take(0.01);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  EXPECT_TRUE(heard_.empty());
}

}  // namespace
}  // namespace alidade
