// The DDS domain that ROS 2 uses, by the module of io/dds, which is loaded on first use.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/dds/dds_module.h"

namespace alidade {

// As ROS 2's own nodes: ROS_DOMAIN_ID (0 to 232, default 0), and ROS_LOCALHOST_ONLY=1 or
// ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST. Throws Error (usage) for an invalid value.
DdsDomain DomainFromEnvironment();

// Nodes of ROS see the participant as the node /`name`. Throws Error (input) when the module is
// missing or the domain cannot be joined.
std::unique_ptr<DdsNode> JoinDomain(const DdsDomain& domain, const std::string& name);

}  // namespace alidade
