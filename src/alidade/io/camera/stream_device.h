// A camera behind an address of the network, decoded by the media module.
#pragma once

#include <memory>
#include <string>

#include "alidade/io/camera/live_device.h"

namespace alidade {

// Throws Error (input) if there is no video at the address, or the media module is missing.
std::unique_ptr<LiveDevice> OpenStreamDevice(const std::string& address);

// Without the user's name and password, for messages and results.
std::string AddressToShow(const std::string& address);

}  // namespace alidade
