// What the program says to slips of the pen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program.h"

namespace alidade::command_line_test {
namespace {

using testing::HasSubstr;

void ExpectUsageError(const std::vector<std::string>& arguments, const std::string& words) {
  const ProgramResult result = RunAlidade(arguments);
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr(words));
  EXPECT_EQ(LineCount(result.err), 1) << result.err;
  EXPECT_EQ(result.out, "");
}

TEST(CommandLine, UnknownCommandNamesTheNearest) {
  ExpectUsageError({"evalute", "ate"}, "did you mean 'evaluate'");
  ExpectUsageError({"evaluate", "rpf", "a", "b"}, "did you mean 'rpe'");
}

TEST(CommandLine, UnknownOptionNamesTheNearest) {
  ExpectUsageError({"--verson"}, "did you mean '--version'");
  ExpectUsageError({"evaluate", "ate", "a", "b", "--aling", "sim3"}, "did you mean '--align'");
  ExpectUsageError({"evaluate", "ate", "--aling=sim3"}, "did you mean '--align'");
}

TEST(CommandLine, UnknownChoiceNamesTheNearest) {
  ExpectUsageError({"evaluate", "ate", "a", "b", "--align", "sim4"}, "did you mean 'sim3'");
}

TEST(CommandLine, WhatIsMissingIsNamed) {
  ExpectUsageError({}, "subcommand");
  ExpectUsageError({"evaluate", "ate", "truth.txt"}, "EST");
}

// CLI11 gives an option that may be repeated all words that follow, unless it is told not to.
TEST(CommandLine, ASettingTakesOneWord) {
  for (const std::string command : {"run", "calibrate"}) {
    const ProgramResult result = RunAlidade({command, "--set", "seed=2", "/nowhere"});
    EXPECT_EQ(result.status, 3) << command;
    EXPECT_THAT(result.err, HasSubstr("/nowhere")) << command;
  }
}

TEST(CommandLine, HelpTeachesWithExamples) {
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{}, {"evaluate", "ate"}, {"evaluate", "rpe"}}) {
    std::vector<std::string> arguments = command;
    arguments.push_back("--help");
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 0);
    EXPECT_THAT(result.out, HasSubstr("Examples:"));
    EXPECT_EQ(result.err, "");
  }
}

TEST(CommandLine, SaysItsVersion) {
  const ProgramResult result = RunAlidade({"--version"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("alidade "));
}

}  // namespace
}  // namespace alidade::command_line_test
