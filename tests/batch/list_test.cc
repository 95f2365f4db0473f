// The list of a batch: words as a shell has them, names of folders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "alidade/run/batch/batch_list.h"
#include "support/expect_error.h"

namespace alidade::batch_list_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(WordsOfLine, AreThoseOfAShell) {
  setenv("ALIDADE_TEST_DATA", "/my data", 1);
  EXPECT_THAT(WordsOfLine("  a  b\tc\r"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(WordsOfLine("'a b' \"c d\" e\\ f ''"), ElementsAre("a b", "c d", "e f", ""));
  EXPECT_THAT(WordsOfLine("$ALIDADE_TEST_DATA/desk ${ALIDADE_TEST_DATA}x '$HOME' $ 5$"),
              ElementsAre("/my data/desk", "/my datax", "$HOME", "$", "5$"));
  EXPECT_THAT(WordsOfLine("a # b"), ElementsAre("a"));
  EXPECT_THAT(WordsOfLine("a#b"), ElementsAre("a#b"));
  EXPECT_THAT(WordsOfLine("# nothing"), ElementsAre());
  EXPECT_THAT(WordsOfLine("synth:room?frames=30&seed=2"),
              ElementsAre("synth:room?frames=30&seed=2"));
  EXPECT_THAT(WordsOfLine("~/x a~/b"),
              ElementsAre(std::string(std::getenv("HOME")) + "/x", "a~/b"));
}

TEST(WordsOfLine, SaysWhatIsWrong) {
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [] { WordsOfLine("a 'b"); }), HasSubstr("not closed"));
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [] { WordsOfLine("$ALIDADE_NOT_SET/x"); }),
              HasSubstr("$ALIDADE_NOT_SET is not set"));
}

TEST(ParseBatchList, NamesFoldersAfterSourcesUnlessTold) {
  const auto items = ParseBatchList(
      "# two visits\n"
      "/data/kitchen/ --last 299\n"
      "\n"
      "/data/kitchen --first 300 --out=evening\n"
      "/other/kitchen\n"
      "walk.mp4 --fov 70\n"
      "synth:room?frames=30&seed=2\n"
      "/bags/walk.bag?image=/cam0/image\n",
      "list.txt", {"--seed", "3"});
  ASSERT_EQ(items.size(), 6u);
  EXPECT_EQ(items[0].name, "kitchen");
  EXPECT_EQ(items[0].line, 2);
  EXPECT_THAT(items[0].words, ElementsAre("/data/kitchen/", "--last", "299", "--seed", "3"));
  EXPECT_EQ(items[1].name, "evening");
  EXPECT_THAT(items[1].words, ElementsAre("/data/kitchen", "--first", "300", "--seed", "3"));
  EXPECT_EQ(items[2].name, "kitchen-2");
  EXPECT_EQ(items[3].name, "walk");
  EXPECT_EQ(items[4].name, "room_frames_30_seed_2");
  EXPECT_EQ(items[5].name, "walk-2");
}

TEST(ParseBatchList, ALineKeepsItsFolderWhenOthersComeAndGo) {
  const auto names = [](const std::string& text) {
    const auto is_others = [](const std::string& name, const std::string& source) {
      return (name == "walk" && source != "a/walk") || (name == "walk-2" && source != "b/walk");
    };
    std::vector<std::string> all;
    for (const BatchItem& item : ParseBatchList(text, "list.txt", {}, is_others))
      all.push_back(item.name);
    return all;
  };
  EXPECT_THAT(names("a/walk\nb/walk\n"), ElementsAre("walk", "walk-2"));
  EXPECT_THAT(names("b/walk\na/walk\n"), ElementsAre("walk-2", "walk"));
  EXPECT_THAT(names("c/walk\nb/walk\n"), ElementsAre("walk-3", "walk-2"));
}

TEST(ParseBatchList, ALineComesBackAsItWas) {
  const auto items = ParseBatchList("'it''s here' --out x \"a'b\"\n", "list.txt", {});
  const auto again = ParseBatchList(LineOf(items[0]) + "\n", "list.txt", {});
  EXPECT_EQ(again[0].words, items[0].words);
  EXPECT_EQ(again[0].name, items[0].name);
}

TEST(ParseBatchList, SaysWhichLineIsWrong) {
  const auto complaint = [](const std::string& text) {
    return MessageOf(ErrorKind::kUsage, [&] { ParseBatchList(text, "list.txt", {}); });
  };
  EXPECT_THAT(complaint("a\nb 'c\n"), HasSubstr("list.txt:2: "));
  EXPECT_THAT(complaint("--sensor mono a\n"), HasSubstr("begin with its source"));
  EXPECT_THAT(complaint("a --out x\nb --out x\n"), HasSubstr("another line has the same name"));
  EXPECT_THAT(complaint("a --out ../x\n"), HasSubstr("name of a folder"));
  EXPECT_THAT(complaint("a --out log\n"), HasSubstr("itself writes a file"));
  EXPECT_THAT(complaint("# nothing\n"), HasSubstr("no recording"));
}

}  // namespace
}  // namespace alidade::batch_list_test
