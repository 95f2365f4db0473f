// Names with blanks, quotes, markup, Unicode and newlines; folders that cannot be written to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/program.h"

namespace alidade::names_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr char kOddName[] = "a \"b\" 'c' <i>d & \xc3\xbc $(touch pwned) `id` #%\nline | \\n";

// A short recording on disk, in a folder of this name.
std::string RecordingIn(const TempFolder& folder, const std::string& name) {
  const std::string path = folder / name;
  EXPECT_EQ(RunAlidade({"synth", "desk", path, "--frames", "12", "--width", "320", "--height",
                        "240", "--quiet"})
                .status,
            0);
  return path;
}

std::string ShellOutput(const std::string& command, const std::string& in) {
  return RunProgram("/bin/bash", {"-c", command}, nullptr, in).out;
}

TEST(Names, OfAnyKindAreTakenAndShownAsTheyAre) {
  const TempFolder folder;
  RecordingIn(folder, kOddName);
  const auto run = RunAlidade({"run", kOddName, "--record"}, nullptr, folder.path());
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string result = std::string("alidade-out/") + kOddName;
  // One line each, whatever is in the names: depth, frames, where, what to do, the stream.
  EXPECT_EQ(LineCount(run.out), 5) << run.out;
  const std::string view = run.out.substr(run.out.find("alidade view ") + 13);
  EXPECT_EQ(ShellOutput("printf %s " + view.substr(0, view.find('\n')), folder.path()), result);
  const std::string open = run.out.substr(run.out.find("\nOpen ") + 6);
  EXPECT_EQ(ShellOutput("printf %s " + open.substr(0, open.find(", or:")), folder.path()),
            result + "/report.html");
  EXPECT_FALSE(fs::exists(folder / "pwned"));

  const auto stats = nlohmann::json::parse(ReadText(folder / (result + "/stats.json")));
  EXPECT_EQ(stats["source"], kOddName);
  EXPECT_EQ(stats["tracked"], 12);
  const std::string report = ReadText(folder / (result + "/report.html"));
  EXPECT_THAT(report, Not(HasSubstr("<i>d")));
  EXPECT_THAT(report, HasSubstr("&lt;i&gt;d &amp; \xc3\xbc"));

  // What reads results.
  const std::string out = std::string("to ") + kOddName;
  for (const auto& [to, ending] : std::vector<std::pair<std::string, std::string>>{
           {"ply", ".ply"}, {"tum", ".txt"}, {"mcap", ".mcap"}, {"nerfstudio", ""}}) {
    const auto exported =
        RunAlidade({"export", "--to", to, result, out + ending}, nullptr, folder.path());
    EXPECT_EQ(exported.status, 0) << to << ": " << exported.err;
    EXPECT_TRUE(fs::exists(folder / (out + ending))) << to;
  }
  const auto compared =
      RunAlidade({"compare", result, std::string("./") + result, "--out", out + ".html"}, nullptr,
                 folder.path());
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(ReadText(folder / (out + ".html")), Not(HasSubstr("<i>d")));
  const auto localized =
      RunAlidade({"localize", kOddName, "--map", result + "/map.alidade"}, nullptr, folder.path());
  EXPECT_EQ(localized.status, 0) << localized.err;
}

TEST(Names, ThatBeginWithADashAreNoOptionsWhenCopied) {
  const TempFolder folder;
  RecordingIn(folder, "desk");
  const auto run = RunAlidade({"run", "desk", "--out=-x"}, nullptr, folder.path());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("alidade view ./-x\n"));
}

TEST(Names, InABatchAreTextInItsTables) {
  const TempFolder folder;
  RecordingIn(folder, "desk");
  std::ofstream(folder / "list") << "desk --out 'a | <i>b & \"c\"'\n";
  const auto batch =
      RunAlidade({"batch", "list", "--out", "all of <i>them"}, nullptr, folder.path());
  ASSERT_EQ(batch.status, 0) << batch.err;
  const std::string table = ReadText(folder / "all of <i>them/batch.md");
  EXPECT_THAT(table, HasSubstr("| a \\| &lt;i>b &amp; \"c\" |"));
  EXPECT_THAT(ReadText(folder / "all of <i>them/compare.html"), Not(HasSubstr("<i>b")));
  const auto json = nlohmann::json::parse(ReadText(folder / "all of <i>them/batch.json"));
  EXPECT_THAT(json.dump(), HasSubstr("a | <i>b & \\\"c\\\""));
}

// The program without the rights of root, and without a home.
ProgramResult RunAsNobody(const std::vector<std::string>& arguments, const std::string& in) {
  std::vector<std::string> words = {"-u", "HOME", ALIDADE_BINARY};
  if (geteuid() == 0)
    words = {"-u",          "HOME", "setpriv", "--reuid=65534", "--regid=65534", "--clear-groups",
             ALIDADE_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return RunProgram("/usr/bin/env", words, nullptr, in);
}

TEST(Names, OfFoldersThatCannotBeWrittenToAreNamedAndNothingIsLost) {
  const TempFolder folder;
  RecordingIn(folder, "desk");
  chmod(folder.path().c_str(), 0755);
  ASSERT_EQ(
      RunAlidade({"run", "desk", "--out", "result", "--quiet"}, nullptr, folder.path()).status, 0);
  fs::create_directory(folder / "mine");
  std::ofstream(folder / "mine/list") << "../desk\n";
  for (const char* there : {"mine", "result", "desk", "."}) chmod((folder / there).c_str(), 0555);
  if (RunAsNobody({"info", "result"}, folder.path()).status != 0)
    GTEST_SKIP() << "the program cannot be run without the rights of root here";
  const std::string before = ReadText(folder / "result/trajectory.txt");
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"run", "desk"},
           {"run", "desk", "--out", "result"},
           {"run", "desk", "--out", "mine/new"},
           {"localize", "desk", "--map", "result/map.alidade", "--out", "mine/new"},
           {"synth", "desk", "mine/new", "--frames", "3"},
           {"export", "result", "mine/new.ply", "--to", "ply"},
           {"export", "result", "mine/new", "--to", "colmap"},
           {"export", "result", "mine/new", "--to", "nerfstudio"},
           {"export", "result", "mine/new.mcap", "--to", "mcap"},
           {"compare", "result", "./result/../result", "--out", "mine/new.html"},
           {"batch", "mine/list", "--out", "mine/new"}}) {
    const auto run = RunAsNobody(arguments, folder.path());
    EXPECT_EQ(run.status, 3) << arguments[0] << " " << arguments.back() << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr("ermission denied")) << arguments[0];
    EXPECT_EQ(LineCount(run.err), 1) << run.err;
    const std::string place = arguments.size() > 2 ? "mine" : "alidade-out/desk";
    EXPECT_THAT(run.err, testing::AnyOf(HasSubstr(place), HasSubstr("result"))) << arguments[0];
    EXPECT_THAT(run.err, Not(HasSubstr(".tmp"))) << "a name the user does not know";
  }
  EXPECT_EQ(ReadText(folder / "result/trajectory.txt"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "mine"), {}), 1);
  for (const char* there : {".", "mine", "result", "desk"}) chmod((folder / there).c_str(), 0755);
}

TEST(Names, AHomeIsNotNeeded) {
  const TempFolder folder;
  RecordingIn(folder, "desk");
  chmod(folder.path().c_str(), 0777);
  const auto run = RunAsNobody({"run", "desk", "--semidense", "--record"}, folder.path());
  if (run.status == 127 || run.err.find("setpriv") != std::string::npos)
    GTEST_SKIP() << "the program cannot be run without the rights of root here";
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(fs::exists(folder / "alidade-out/desk/report.html"));
}

}  // namespace
}  // namespace alidade::names_test
