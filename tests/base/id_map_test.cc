#include "alidade/base/id_map.h"

#include <gtest/gtest.h>

#include <map>

#include "alidade/base/ids.h"
#include "alidade/base/random.h"

namespace alidade::id_map_test {
namespace {

TEST(IdMap, DoesWhatStdMapDoes) {
  Random random(5);
  IdMap<LandmarkId, int> tally;
  std::map<uint32_t, int> expected;
  for (int i = 0; i < 20000; ++i) {
    const uint32_t id =
        random.Below(3000) * 1000003u;  // widely spaced, including multiples of powers of two
    ++tally[{id}];
    ++expected[id];
    if (i % 5000 == 4999) {
      const auto odd = [](int count) { return count % 2 == 1; };
      tally.EraseIf([&](LandmarkId, int count) { return odd(count); });
      std::erase_if(expected, [&](const auto& entry) { return odd(entry.second); });
    }
  }
  ASSERT_EQ(tally.size(), expected.size());
  for (const auto& [id, count] : expected) {
    ASSERT_TRUE(tally.Contains({id}));
    EXPECT_EQ(*tally.Find({id}), count);
  }
  EXPECT_FALSE(tally.Contains({17}));
}

TEST(IdMap, KeepsTheOrderOfEntering) {
  IdMap<KeyFrameId, int> map;
  for (uint32_t id : {900000000u, 3u, 70u, 3u, 1u}) map[{id}] = 1;
  std::vector<uint32_t> ids;
  for (const auto& entry : map.entries()) ids.push_back(entry.first.value);
  EXPECT_EQ(ids, (std::vector<uint32_t>{900000000u, 3u, 70u, 1u}));
}

TEST(IdMap, IsEmptyAfterClearing) {
  IdSet<LandmarkId> set;
  EXPECT_FALSE(set.Contains({4}));
  EXPECT_TRUE(set.Enter({4}));
  EXPECT_FALSE(set.Enter({4}));
  set.Clear();
  EXPECT_FALSE(set.Contains({4}));
  EXPECT_TRUE(set.Enter({4}));
}

}  // namespace
}  // namespace alidade::id_map_test
