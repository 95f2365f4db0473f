// Topics of ROS 2 as they are published, as a source of frames.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "alidade/inertial/imu.h"
#include "alidade/io/files/open_source.h"
#include "alidade/io/frame_source.h"

namespace alidade {

inline constexpr char kRos2Source[] = "ros2:";

// true for `ros2:`, also with `?image=TOPIC&depth=TOPIC…` as for a recording (BagQuery).
bool IsRos2Source(const std::string& source);

// A live source of topics: each frame is the newest image, with the depth or right image and the
// inertial readings that belong to it.
class TopicSource : public FrameSource {
 public:
  // The inertial sensor that the topics tell of, of the camera as mounted; nullopt: none.
  virtual const std::optional<ImuModel>& ImuTold() const = 0;
  // Frames come with readings, of this sensor: see SourceInfo::imu. Before the first frame.
  virtual void UseImu(const ImuModel& model) = 0;
};

// Joins the domain of the environment (DomainFromEnvironment()), waits for images for as long as it
// takes, and chooses among the topics that were published in the next seconds as for a recording.
// Warns while nothing comes. Throws Error: kUsage for an option or topic that does not fit, kInput
// when the domain cannot be joined, or options.interrupted() ended the wait.
std::unique_ptr<TopicSource> OpenRos2Source(const std::string& source,
                                            const SourceOptions& options);

}  // namespace alidade
