#include "alidade/run/ros2/ros2_commands.h"

#include <exception>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"

namespace alidade {
namespace {

constexpr char kSave[] = "/alidade/save", kReset[] = "/alidade/reset",
               kLocalizeOnly[] = "/alidade/localize_only";
constexpr int kWaiting = 10;  // commands that wait at most
constexpr double kWait = 1;   // seconds until Wake() would have been missed
constexpr size_t kCdrHeader = 4;

}  // namespace

Ros2Commands::Ros2Commands(DdsNode& node, std::function<void()> save)
    : node_(node), save_(std::move(save)) {
  const std::pair<const char*, const char*> wanted[] = {
      {kSave, "std_msgs/Empty"}, {kReset, "std_msgs/Empty"}, {kLocalizeOnly, "std_msgs/Bool"}};
  for (const auto& [topic, type] : wanted) {
    std::string problem;
    const int subscription =
        node_.Subscribe(topic, type, DdsQuality::kReliable, kWaiting, &problem);
    if (subscription < 0) LogWarning(std::string(topic) + " is not heard: " + problem);
    topics_[subscription] = topic;
  }
  thread_ = std::thread([this] { Listen(); });
}

Ros2Commands::~Ros2Commands() {
  ends_ = true;
  node_.Wake();
  thread_.join();
}

RunRequest Ros2Commands::Take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(asked_, {});
}

void Ros2Commands::Listen() {
  while (!ends_) {
    for (const DdsMessage& message : node_.Take(kWait)) {
      try {
        Obey(topics_[message.subscription], message.bytes);
      } catch (...) {
        LogWarning(topics_[message.subscription] + ": " + WhatOf(std::current_exception()));
      }
    }
  }
}

void Ros2Commands::Obey(const std::string& topic, std::string_view message) {
  if (topic == kSave) {
    save_();
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (topic == kReset) asked_.forget = true;
  if (topic == kLocalizeOnly && message.size() > kCdrHeader)
    asked_.mapping = message[kCdrHeader] == 0;
}

}  // namespace alidade
