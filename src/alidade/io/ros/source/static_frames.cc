#include "alidade/io/ros/source/static_frames.h"

#include <map>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {
namespace {

// For each frame its neighbors, T_frame_neighbor.
using Frames = std::map<std::string, std::vector<std::pair<std::string, Se3>>>;

Frames StaticFrames(BagFile& bag) {
  Frames frames;
  for (size_t topic = 0; topic < bag.Topics().size(); ++topic) {
    const BagTopic& about = bag.Topics()[topic];
    if (!IsTransformType(about.type) || about.name.find("tf_static") == std::string::npos) continue;
    for (const BagMessage& message : bag.Messages(topic)) {
      try {
        std::string bytes;
        if (!bag.Read(message, bytes).empty()) continue;
        for (const RosFrame& frame : ParseRosTransforms(bytes, about.serialization)) {
          frames[frame.parent].push_back({frame.child, frame.T_parent_child});
          frames[frame.child].push_back({frame.parent, frame.T_parent_child.Inverse()});
        }
      } catch (const Error&) {  // tells nothing
      }
    }
  }
  return frames;
}

}  // namespace

std::optional<Se3> StaticTransform(BagFile& bag, std::string from, std::string to) {
  for (std::string* name : {&from, &to}) {
    if (!name->empty() && name->front() == '/') name->erase(0, 1);
  }
  if (from.empty() || to.empty()) return std::nullopt;
  const Frames frames = StaticFrames(bag);
  std::map<std::string, Se3> reached = {{from, Se3()}};
  std::vector<std::string> open = {from};
  while (!open.empty() && reached.find(to) == reached.end()) {
    const std::string frame = open.back();
    open.pop_back();
    const auto neighbors = frames.find(frame);
    if (neighbors == frames.end()) continue;
    for (const auto& [next, T_frame_next] : neighbors->second) {
      if (reached.emplace(next, reached[frame] * T_frame_next).second) open.push_back(next);
    }
  }
  const auto found = reached.find(to);
  return found == reached.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace alidade
