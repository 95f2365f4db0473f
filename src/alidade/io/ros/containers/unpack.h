// Packed bytes to plain ones, by libbz2, liblz4 and libzstd.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace alidade {

// What a chunk or a message may have at most once it is unpacked. A picture of kMostPixels with
// three bytes each has 192 MB; recorders close chunks after some megabytes.
inline constexpr uint64_t kMostUnpacked = uint64_t{1} << 29;

// `format`: "" or "none", "bz2", "lz4" (frames), "zstd" (frames). Memory grows with what is
// unpacked, not with what a header claims. Throws Error (input) when the bytes are damaged, the
// format is unknown, or there are more than `most`.
std::string Unpack(std::string_view format, std::string_view packed, uint64_t most = kMostUnpacked);

// How much so many packed bytes may become. Even black pictures pack to no less than a thousandth,
// but for a chunk's worth of them.
uint64_t MostUnpackedFrom(uint64_t packed);

bool LooksLikeZstd(std::string_view bytes);

}  // namespace alidade
