#include "alidade/base/nearest_name.h"

#include <gtest/gtest.h>

#include <vector>

namespace alidade::nearest_name_test {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(EditDistance("", ""), 0);
  EXPECT_EQ(EditDistance("abc", ""), 3);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
  EXPECT_EQ(EditDistance("frist", "first"), 1);
  EXPECT_EQ(EditDistance("THREADS", "threads"), 0);
}

// A whole file's text instead of a name: computing its edit distance would take minutes.
TEST(NearestName, ComparesNoBooks) {
  const std::vector<std::string> known(200, "tracker.extractor.features");
  EXPECT_EQ(NearestName(std::string(1 << 20, 'a'), known), "");
}

TEST(NearestName, FindsWhatWasMeant) {
  const std::vector<std::string> known = {"--sensor", "--seed", "--schedule", "--threads"};
  EXPECT_EQ(NearestName("--shedule", known), "--schedule");
  EXPECT_EQ(NearestName("--thread", known), "--threads");
  EXPECT_EQ(NearestName("--sede", known), "--seed");
}

TEST(NearestName, SaysNothingWhenNothingIsNear) {
  const std::vector<std::string> known = {"sensor", "seed"};
  EXPECT_EQ(NearestName("completely-else", known), "");
  EXPECT_EQ(DidYouMean("completely-else", known), "");
  EXPECT_EQ(DidYouMean("sed", known), "; did you mean 'seed'?");
}

}  // namespace
}  // namespace alidade::nearest_name_test
