// Tables of a batch, and what is worse than in an earlier one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alidade/run/batch/batch_table.h"
#include "support/expect_error.h"

namespace alidade::batch_table_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

BatchRow Ok(const std::string& name, double ate) {
  BatchRow row;
  row.name = name;
  row.state = "ok";
  row.sensor = "rgbd";
  row.frames = 100;
  row.coverage = 0.98;
  row.ate = ate;
  row.ms = 10;
  return row;
}

BatchRow Failed(const std::string& name) {
  BatchRow row;
  row.name = name;
  row.state = "failed";
  row.message = "no images | none";
  return row;
}

TEST(BatchJson, IsReadAgain) {
  const std::vector<BatchRow> rows = {Ok("a", 0.1234567890123), Failed("b")};
  const auto again = ParseBatchJson(BatchJson(rows), "batch.json");
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0].ate, rows[0].ate);
  EXPECT_EQ(again[0].rpe, std::nullopt);
  EXPECT_TRUE(again[0].ok());
  EXPECT_EQ(again[1].message, "no images | none");
  EXPECT_FALSE(again[1].ok());
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { ParseBatchJson("[]", "x.json"); }),
              HasSubstr("x.json"));
}

TEST(BatchMarkdown, HasALineForEach) {
  const std::string text = BatchMarkdown({Ok("a", 0.1), Failed("b")});
  EXPECT_THAT(text, HasSubstr("| a | rgbd | 100 | 98.0 | – | 0.1000 |"));
  EXPECT_THAT(text, HasSubstr("| b | failed: no images \\| none | – |"));
}

TEST(ParseWorseBy, KnowsUnits) {
  const std::vector<std::pair<std::string, double>> length = {{"mm", 1e-3}, {"m", 1}};
  EXPECT_DOUBLE_EQ(ParseWorseBy("--x", "10%", length).share, 0.1);
  EXPECT_DOUBLE_EQ(ParseWorseBy("--x", "5 mm", length).amount, 0.005);
  EXPECT_FALSE(ParseWorseBy("--x", "off", length).on());
  for (const char* wrong : {"5", "mm", "-1mm", "5km", "", "0%"}) {
    EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { ParseWorseBy("--x", wrong, length); }),
                HasSubstr("(%, mm, m)"))
        << wrong;
  }
}

TEST(WorseThan, TellsWhatGrewAndWhatFailed) {
  const std::vector<BatchRow> before = {Ok("a", 0.100), Ok("b", 0.100), Ok("c", 0.1), Failed("d"),
                                        Ok("gone", 0.1)};
  std::vector<BatchRow> now = {Ok("a", 0.109), Ok("b", 0.111), Failed("c"), Failed("d"),
                               Ok("new", 9)};
  EXPECT_THAT(WorseThan(before, now, {}),
              UnorderedElementsAre("b: ATE 0.1110 m, was 0.1000 m",
                                   "c: failed: no images | none, and was ok before"));
  WorseSettings by_length;
  by_length.ate = {0, 0.005};
  EXPECT_THAT(WorseThan(before, {Ok("b", 0.104)}, by_length), IsEmpty());
  EXPECT_EQ(WorseThan(before, {Ok("b", 0.106)}, by_length).size(), 1u);
}

TEST(WorseThan, FewerFramesAreWorseAndTimesOnlyWhenAsked) {
  BatchRow now = Ok("a", 0.1);
  now.coverage = 0.96;
  now.ms = 20;
  EXPECT_THAT(WorseThan({Ok("a", 0.1)}, {now}, {}), ElementsAre("a: tracked 96.0 %, was 98.0 %"));
  WorseSettings times;
  times.coverage = {};
  times.ms = {0.5, 0};
  EXPECT_THAT(WorseThan({Ok("a", 0.1)}, {now}, times),
              ElementsAre("a: median 20.0 ms, was 10.0 ms"));
  now.ate.reset();
  EXPECT_THAT(WorseThan({Ok("a", 0.1)}, {now}, {}).front(), HasSubstr("ATE is unknown"));
}

}  // namespace
}  // namespace alidade::batch_table_test
