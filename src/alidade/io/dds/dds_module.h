// Interface of libalidade_dds.so: a participant of a DDS domain that publishes and takes ROS 2
// messages as bytes. io/ros/live/domain.cc loads it on first use; no target links it. The program
// and the module are built together, so the interface may use C++ types; only the function name is
// C. Only std::bad_alloc may leave the module as an exception.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// Quality of service.
enum class DdsQuality {
  kSensor,    // best effort: a lost message is not sent again; as ROS 2's sensor data
  kReliable,  // lost messages are sent again; as ROS 2's default
  kLatched    // reliable, and who joins later gets the last messages; as /tf_static
};

// A publication of another participant. Topics and types are named as in ROS: "/camera/image_raw",
// "sensor_msgs/Image".
struct DdsPublication {
  std::string topic, type;
  DdsQuality quality = DdsQuality::kSensor;
};

struct DdsMessage {
  int subscription = -1;
  int64_t sent = 0;   // by the publisher's clock, nanoseconds since 1970
  std::string bytes;  // CDR, with its header of 4 bytes
};

struct DdsDomain {
  int id = 0;               // 0 to 232
  bool local_only = false;  // this machine's loopback interface only
};

// A participant, which is a node of that name to others (`ros2 node list`): told by Take(). Any
// thread may make any call; Take() one at a time.
class DdsNode {
 public:
  virtual ~DdsNode() = default;

  // Those on topics of ROS 2 that are known by now; discovery takes a second.
  virtual std::vector<DdsPublication> Publications() = 0;

  // Takes messages of a topic from now on, the newest `depth` of those not taken yet. Returns the
  // number of the subscription, or -1 and sets `problem`: the type is unknown to the module.
  virtual int Subscribe(const std::string& topic, const std::string& type, DdsQuality quality,
                        int depth, std::string* problem) = 0;
  virtual void Unsubscribe(int subscription) = 0;
  // Blocks until there are messages, for at most `seconds`, or until Wake(). Returns them in order
  // of arrival for each subscription. Samples that are not CDR of their type never arrive.
  virtual std::vector<DdsMessage> Take(double seconds) = 0;
  virtual void Wake() = 0;

  // As Subscribe().
  virtual int Advertise(const std::string& topic, const std::string& type, DdsQuality quality,
                        std::string* problem) = 0;
  // Returns false if the bytes are not CDR of the type.
  virtual bool Publish(int publication, std::string_view bytes) = 0;
  virtual int Listeners(int publication) = 0;  // matched subscriptions of others, now

  // Sentences for users: whose quality of service does not match, each once.
  virtual std::vector<std::string> News() = 0;
};

inline constexpr char kDdsModuleFile[] = "libalidade_dds.so";
inline constexpr char kDdsModuleJoin[] = "alidade_dds_join";

// Returns null and sets `problem`, one line, on failure. `name`: of the node, as in DdsNode.
using DdsJoinFunction = DdsNode*(const DdsDomain& domain, const std::string& name,
                                 std::string* problem);

}  // namespace alidade
