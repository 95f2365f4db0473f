// Another vendor's participant: eProsima Fast DDS publishes and hears ROS 2 messages as bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace alidade {

// One participant on loopback. Names of topics and types as DDS has them: "rt/image",
// "sensor_msgs::msg::dds_::Image_".
class FastPeer {
 public:
  explicit FastPeer(int domain);
  ~FastPeer();
  FastPeer(const FastPeer&) = delete;
  FastPeer& operator=(const FastPeer&) = delete;

  enum class Quality { kBestEffort, kReliable, kLatched };
  // Returns the number of the publication. `bytes` of Publish(): CDR with its header.
  int Advertise(const std::string& topic, const std::string& type, Quality quality,
                const std::string& user_data = "");
  void Publish(int publication, const std::string& bytes);
  int Listeners(int publication);
  // `heard` is called from a thread of Fast DDS.
  void Subscribe(const std::string& topic, const std::string& type, Quality quality,
                 std::function<void(std::string bytes)> heard);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace alidade
