// The checksum of MCAP, zip and PNG: CRC-32 of ISO 3309, polynomial 0x04c11db7, bits reflected.
#pragma once

#include <cstdint>
#include <string_view>

namespace alidade {

// Of `bytes`; or of what had the checksum `before`, and then `bytes`.
uint32_t Crc32(std::string_view bytes, uint32_t before = 0);

}  // namespace alidade
