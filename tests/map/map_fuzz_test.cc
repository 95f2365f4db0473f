// Damaged maps are rejected with one clear error; or, if the checksum was repaired and the contents
// are valid, accepted like any other. Few cases per normal run, many with scripts/test --long;
// under the sanitizers they show that nothing is read out of bounds.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <vector>

#include "alidade/base/random.h"
#include "support/expect_error.h"
#include "support/map_bytes.h"
#include "support/saved_map.h"
#include "support/use_map.h"

namespace alidade::map_fuzz_test {
namespace {

bool Long() { return std::getenv("ALIDADE_LONG_TESTS") != nullptr; }

SavedMap Tiny() { return MakeSavedMap({.points = 40, .cameras = 5, .clutter = 2}); }

// Either rejects the bytes with an input error, or decodes them; any other outcome fails.
bool Refused(std::string_view bytes) {
  SavedMap saved;
  try {
    saved = DecodeMap(bytes);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_GT(std::string(error.what()).size(), 10u);
    return true;
  }
  EXPECT_EQ(UseMap(saved), "");
  return false;
}

TEST(MapFuzz, EveryTruncationOfATinyMapIsRefused) {
  const std::string bytes = EncodeMap(Tiny());
  for (size_t size = 0; size < bytes.size(); ++size) {
    // An exact-size copy, so that the sanitizer detects reads past the end.
    const std::vector<char> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_TRUE(Refused({cut.data(), cut.size()})) << size << " of " << bytes.size();
    std::string repaired(cut.begin(), cut.end());
    if (size % 16 == 0 && RepairChecksum(repaired)) Refused(repaired);
  }
}

TEST(MapFuzz, TruncationsOfALargerMapAreRefused) {
  const std::string bytes = EncodeMap(MakeSavedMap());
  const size_t places = Long() ? 5000 : 100;
  for (size_t i = 0; i < places; ++i) {
    ASSERT_TRUE(Refused(std::string_view(bytes).substr(0, bytes.size() * i / places)));
  }
}

TEST(MapFuzz, AnyFlippedBitIsNoticed) {
  const std::string bytes = EncodeMap(MakeSavedMap());
  Random random(11);
  for (int i = 0; i < (Long() ? 10000 : 300); ++i) {
    std::string damaged = bytes;
    const uint32_t at = random.Below(static_cast<uint32_t>(bytes.size()));
    damaged[at] ^= static_cast<char>(1 << random.Below(8));
    ASSERT_TRUE(Refused(damaged)) << at;
  }
}

// Deliberate damage: up to four flipped bits with a repaired checksum.
void FlipWithRepairedChecksum(const SavedMap& saved, int times, uint64_t seed) {
  const std::string bytes = EncodeMap(saved);
  Random random(seed);
  int read = 0;
  for (int i = 0; i < times; ++i) {
    std::string damaged = bytes;
    for (uint32_t flips = 1 + random.Below(4); flips > 0; --flips) {
      damaged[random.Below(static_cast<uint32_t>(bytes.size()))] ^=
          static_cast<char>(1 << random.Below(8));
    }
    if (RepairChecksum(damaged)) read += !Refused(damaged);
  }
  EXPECT_GT(read, times / 10);  // e.g. a flipped bit of a descriptor is valid
}

TEST(MapFuzz, FlippedBitsWithAChecksumThatFitsDoNoHarm) {
  FlipWithRepairedChecksum(MakeSavedMap(), Long() ? 10000 : 150, 12);
}

// Few keypoints, so that more flips hit tables, offsets and counts.
TEST(MapFuzz, FlippedBitsOfATinyMapWithAChecksumThatFitsDoNoHarm) {
  FlipWithRepairedChecksum(Tiny(), Long() ? 10000 : 300, 13);
}

// Regions dense in counts and offsets: every bit of the end (tables are written last to first) and
// of the root.
TEST(MapFuzz, EveryBitOfTheFirstKilobyteDoesNoHarm) {
  const std::string bytes = EncodeMap(Tiny());
  for (size_t bit = 0; bit < 8 * 1024; bit += Long() ? 1 : 7) {
    std::string damaged = bytes;
    damaged[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    if (RepairChecksum(damaged)) Refused(damaged);
  }
}

// Replaces whole words by critical values.
TEST(MapFuzz, ExtremeNumbersDoNoHarm) {
  const std::string bytes = EncodeMap(Tiny());
  const uint32_t extremes[] = {0,          1,          0x7fffffff, 0x80000000, 0xffffffff,
                               0x00400000, 0x04000000, 0x7f800000, 0x7fc00000};  // inf, NaN
  Random random(14);
  for (int i = 0; i < (Long() ? 10000 : 300); ++i) {
    std::string damaged = bytes;
    const size_t at = 4 * random.Below(static_cast<uint32_t>(bytes.size() / 4));
    std::memcpy(damaged.data() + at, &extremes[random.Below(9)], 4);
    if (RepairChecksum(damaged)) Refused(damaged);
  }
}

}  // namespace
}  // namespace alidade::map_fuzz_test
