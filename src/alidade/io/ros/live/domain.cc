#include "alidade/io/ros/live/domain.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr int kHighestDomain = 232;  // DDSI-RTPS 9.6.1: ports are 7400 + 250 * domain

const LoadedFunction<DdsJoinFunction>& TheDdsModule() {
  static const auto module = LoadFunction<DdsJoinFunction>(kDdsModuleFile, kDdsModuleJoin);
  return module;
}

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

DdsDomain DomainFromEnvironment() {
  DdsDomain domain;
  if (const std::string id = Variable("ROS_DOMAIN_ID"); !id.empty()) {
    const auto number = ParseNumber(id);
    if (!number || !(*number >= 0 && *number <= kHighestDomain) || *number != std::floor(*number))
      ThrowUsage("ROS_DOMAIN_ID=" + id + ": must be a whole number from 0 to 232");
    domain.id = static_cast<int>(*number);
  }
  domain.local_only = Variable("ROS_LOCALHOST_ONLY") == "1" ||
                      Variable("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST";
  return domain;
}

std::unique_ptr<DdsNode> JoinDomain(const DdsDomain& domain, const std::string& name) {
  const auto& module = TheDdsModule();
  if (module.call == nullptr)
    ThrowInput(std::string("ROS 2 topics need ") + kDdsModuleFile + ": " + module.problem);
  std::string problem;
  std::unique_ptr<DdsNode> node(module.call(domain, name, &problem));
  if (!node)
    ThrowInput("ROS domain " + std::to_string(domain.id) + " cannot be joined: " + problem);
  return node;
}

}  // namespace alidade
