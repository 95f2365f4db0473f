#include "alidade/map/id_table.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "alidade/base/random.h"

namespace alidade::id_table_test {
namespace {

struct Thing {
  uint32_t id = 0;
};

std::vector<uint32_t> Ids(const IdTable<Thing>& table) {
  std::vector<uint32_t> ids;
  table.ForEach([&](const Thing& thing) { ids.push_back(thing.id); });
  return ids;
}

TEST(IdTable, HoldsWhatStdMapHoldsInTheSameOrder) {
  Random random(3);
  IdTable<Thing> table;
  std::map<uint32_t, std::shared_ptr<const Thing>> expected;
  for (uint64_t version = 1; version <= 4000; ++version) {
    // Few and many ids, small and large: levels are added as needed.
    const uint32_t id = random.Below(200) << random.Below(25);
    if (random.Below(3) == 0) {
      table.Erase(id, version);
      expected.erase(id);
    } else {
      const auto thing = std::make_shared<Thing>(Thing{id});
      table.Set(id, thing, version);
      expected[id] = thing;
    }
  }
  EXPECT_EQ(table.size(), static_cast<int>(expected.size()));
  std::vector<uint32_t> ids, back;
  for (const auto& [id, thing] : expected) {
    ids.push_back(id);
    EXPECT_EQ(table.At(id), thing.get());
  }
  EXPECT_EQ(Ids(table), ids);
  EXPECT_EQ(table.At(0xffffffffu), nullptr);
  table.ForEachFromLast([&](const Thing& thing) {
    back.push_back(thing.id);
    return back.size() < 5;
  });
  EXPECT_EQ(back, std::vector<uint32_t>(ids.rbegin(), ids.rbegin() + 5));
}

TEST(IdTable, ACopyStaysAsItWas) {
  IdTable<Thing> table;
  for (uint32_t id = 0; id < 5000; ++id) table.Set(id, std::make_shared<Thing>(Thing{id}), 1);
  const IdTable<Thing> before = table;
  for (uint32_t id = 0; id < 5000; id += 2) table.Erase(id, 2);
  table.Set(1u << 20, std::make_shared<Thing>(Thing{1u << 20}), 2);
  EXPECT_EQ(before.size(), 5000);
  EXPECT_EQ(Ids(before).size(), 5000u);
  EXPECT_EQ(table.size(), 2501);
  EXPECT_EQ(before.At(1u << 20), nullptr);
}

TEST(IdTable, AChangeCopiesOnlyTheWayToIt) {
  IdTable<Thing> table;
  for (uint32_t id = 0; id < 100000; ++id) table.Set(id, std::make_shared<Thing>(Thing{id}), 1);
  const IdTable<Thing> before = table;
  table.Set(77777, std::make_shared<Thing>(Thing{77777}), 2);
  table.Erase(77778, 2);
  EXPECT_EQ(table.tree().CountNodesNotIn(before.tree()), 3);  // 64³ > 100000
  EXPECT_GT(table.tree().CountNodes(), 1500);
}

// The size of a table depends on its contents, not on a million ids erased before.
TEST(IdTable, ForgetsThePast) {
  IdTable<Thing> table;
  for (uint32_t id = 0; id < 1000000; ++id) {
    table.Set(id, std::make_shared<Thing>(Thing{id}), id);
    if (id >= 100) table.Erase(id - 100, id);
  }
  EXPECT_EQ(table.size(), 100);
  EXPECT_LE(table.tree().CountNodes(), 3 + 2 * 3);
  EXPECT_EQ(Ids(table).front(), 999900u);
}

}  // namespace
}  // namespace alidade::id_table_test
