// Words of version 0.1 that are accepted with a warning: --viewer PORT, --record FILE.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/program.h"
#include "support/sliding_recording.h"

namespace alidade::old_forms_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr char kNewViewer[] = "`--viewer PORT` is now `--viewer --port PORT`";
constexpr char kNewRecord[] = "`--record FILE` is now `--record-to FILE`";

class OldForms : public testing::Test {
 protected:
  OldForms() { WriteSlidingTum(recording_); }

  ProgramResult Run(std::vector<std::string> words) {
    words.insert(words.begin(), "run");
    words.insert(words.end(), {"--last", "3", "--overwrite", "--out", at_ / "out"});
    return RunAlidade(words);
  }
  bool Exists(const std::string& name) { return std::filesystem::exists(at_ / name); }

  TempFolder recording_, at_;
};

TEST_F(OldForms, RecordIsAFlagAndRecordToNamesTheFile) {
  const ProgramResult flag = Run({"--record", recording_.path()});
  EXPECT_EQ(flag.status, 0) << flag.err;
  EXPECT_EQ(flag.err, "");
  EXPECT_TRUE(Exists("out/run.stream"));
  const ProgramResult file = Run({"--record-to", at_ / "new.stream", recording_.path()});
  EXPECT_EQ(file.status, 0) << file.err;
  EXPECT_EQ(file.err, "");
  EXPECT_TRUE(Exists("new.stream"));
  EXPECT_FALSE(Exists("out/run.stream"));
  const ProgramResult empty = Run({"--record-to", "", recording_.path()});
  EXPECT_EQ(empty.status, 2);
  EXPECT_THAT(empty.err, HasSubstr("--record-to must not be empty"));
}

TEST_F(OldForms, AFileBehindRecordIsAccepted) {
  const std::vector<std::vector<std::string>> lines = {
      {recording_.path(), "--record", at_ / "old.stream"},
      {"--record", at_ / "old.stream", recording_.path()},
      {recording_.path(), "--record=" + (at_ / "old.stream")}};
  for (const auto& line : lines) {
    std::filesystem::remove(at_ / "old.stream");
    const ProgramResult result = Run(line);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr(kNewRecord));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_TRUE(Exists("old.stream"));
  }
  const ProgramResult empty = Run({recording_.path(), "--record", ""});
  EXPECT_EQ(empty.status, 0) << empty.err;
  EXPECT_THAT(empty.err, HasSubstr(kNewRecord));
  EXPECT_TRUE(Exists("out/run.stream"));
}

// The one word that can be the source is the source.
TEST_F(OldForms, TheOnlyWordIsTheSource) {
  const ProgramResult mcap = Run({"--record", at_ / "walk.mcap"});
  EXPECT_EQ(mcap.status, 3);
  EXPECT_THAT(mcap.err, HasSubstr("walk.mcap"));
  EXPECT_THAT(mcap.err, Not(HasSubstr("is now")));
  const ProgramResult number = Run({"--viewer", "--port", "0", "--sensor", "mono", "8091"});
  EXPECT_EQ(number.status, 3);
  EXPECT_THAT(number.err, HasSubstr("8091"));
  EXPECT_THAT(number.err, Not(HasSubstr("is now")));
}

TEST_F(OldForms, ANumberBehindViewerIsAccepted) {
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{recording_.path(), "--viewer", "0"},
        std::vector<std::string>{"--viewer", "0", recording_.path()},
        std::vector<std::string>{recording_.path(), "--viewer=0"}}) {
    const ProgramResult result = Run(line);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr(kNewViewer));
    EXPECT_THAT(result.out, HasSubstr("Viewer: http://127.0.0.1:"));
  }
  const ProgramResult flag = Run({"--viewer", recording_.path()});  // no number: the source
  EXPECT_EQ(flag.status, 0) << flag.err;
  EXPECT_EQ(flag.err, "");
}

TEST_F(OldForms, BothAtOnce) {
  const ProgramResult result =
      Run({"--record", at_ / "old.stream", "--viewer", "0", recording_.path()});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr(kNewRecord));
  EXPECT_THAT(result.err, HasSubstr(kNewViewer));
  EXPECT_TRUE(Exists("old.stream"));
}

TEST_F(OldForms, APortNeedsAViewerAndIsANumber) {
  const ProgramResult alone = Run({recording_.path(), "--port", "8090"});
  EXPECT_EQ(alone.status, 2);
  EXPECT_THAT(alone.err, HasSubstr("--port is where the viewer listens: it needs --viewer"));
  const ProgramResult word = Run({recording_.path(), "--viewer", "--port", "web"});
  EXPECT_EQ(word.status, 2);
  EXPECT_THAT(word.err, HasSubstr("not 'web'"));
}

TEST_F(OldForms, LinesOfABatchMayHaveThem) {
  const std::string list = at_.Write(
      "list.txt", recording_.path() + " --last 3 --record " + (at_ / "old.stream") + "\n");
  const ProgramResult result = RunAlidade({"batch", list, "--out", at_ / "all"});
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_THAT(result.err, HasSubstr(kNewRecord));
  EXPECT_TRUE(Exists("old.stream"));
}

}  // namespace
}  // namespace alidade::old_forms_test
