// What other nodes ask of a run, on topics (docs/guides/ros2.md).
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "alidade/io/dds/dds_module.h"
#include "alidade/run/play/watcher.h"

namespace alidade {

// Topics: /alidade/save, /alidade/reset (std_msgs/Empty), /alidade/localize_only (std_msgs/Bool).
class Ros2Commands {
 public:
  // Listens from now on, in a thread of its own. `node` must outlive this object. `save` is called
  // in that thread; what it throws is a warning.
  Ros2Commands(DdsNode& node, std::function<void()> save);
  ~Ros2Commands();
  Ros2Commands(const Ros2Commands&) = delete;
  Ros2Commands& operator=(const Ros2Commands&) = delete;

  RunRequest Take();  // what was asked for since the last call; any thread

 private:
  void Listen();
  void Obey(const std::string& topic, std::string_view message);

  DdsNode& node_;
  std::function<void()> save_;
  std::map<int, std::string> topics_;  // by subscription
  std::mutex mutex_;
  RunRequest asked_;  // guarded by mutex_
  std::atomic<bool> ends_{false};
  std::thread thread_;  // last, because it uses the other members
};

}  // namespace alidade
