// CRC-32 as used in MCAP, zip and PNG: ISO 3309, polynomial 0x04c11db7, reflected bits.
#pragma once

#include <cstdint>
#include <string_view>

namespace alidade {

// CRC of `bytes`, or of a longer sequence that ends with `bytes` and whose first part has the CRC
// `before`.
uint32_t Crc32(std::string_view bytes, uint32_t before = 0);

}  // namespace alidade
