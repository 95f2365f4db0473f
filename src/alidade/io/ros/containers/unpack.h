// Decompression by libbz2, liblz4 and libzstd.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace alidade {

// Size limit of an unpacked chunk or message, bytes. An image of kMostPixels with 3 bytes per pixel
// has 192 MB; recorders close chunks after a few megabytes.
inline constexpr uint64_t kMostUnpacked = uint64_t{1} << 29;

// `format`: "" or "none", "bz2", "lz4" (frame format), "zstd" (frame format). Memory use follows
// the actual output, not the size stated in a header. Throws Error (input) when the data is
// damaged, the format is unknown, or the output exceeds `most` bytes.
std::string Unpack(std::string_view format, std::string_view packed, uint64_t most = kMostUnpacked);

// Limit of the unpacked size of `packed` compressed bytes: 1024 times as many, but at least 64 MB
// and at most kMostUnpacked. Even black images compress to no less than about a thousandth.
uint64_t MostUnpackedFrom(uint64_t packed);

// The same for a whole file, which may have any size: kMostFileRatio times as many, but at least 64
// MB.
inline constexpr uint64_t kMostFileRatio = 1024;
uint64_t MostUnpackedFileFrom(uint64_t packed);

bool LooksLikeZstd(std::string_view bytes);

}  // namespace alidade
