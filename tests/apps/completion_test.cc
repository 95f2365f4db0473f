// Completions, tested in the shells; manual pages, in their viewer; docs/reference/cli.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/program.h"

namespace alidade::completion_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

namespace fs = std::filesystem;

bool Exists(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

// Words of a script's lines.
std::vector<std::string> LinesOf(const std::string& command) {
  const TempFolder folder;
  const std::string out = folder / "out";
  EXPECT_EQ(std::system((command + " >" + out + " 2>&1").c_str()), 0) << ReadText(out);
  std::vector<std::string> lines;
  std::istringstream text(ReadText(out));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

void Write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// A folder with the script of a shell and some files to be found.
class Completed : public testing::Test {
 protected:
  Completed() { Write(folder_ / "walk.mp4", ""); }

  void Ask(const std::string& shell) {
    const ProgramResult result = RunAlidade({"completion", shell});
    ASSERT_EQ(result.status, 0) << result.err;
    Write(folder_ / "script", result.out);
  }
  // `words` are what stands on the line, the last of which is being typed.
  std::vector<std::string> Bash(const std::vector<std::string>& words) {
    std::string list;
    for (const std::string& word : words) list += " '" + word + "'";
    Write(folder_ / "ask", "cd " + folder_.path() + " && . ./script\nCOMP_WORDS=(" + list +
                               ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_alidade\n"
                               "printf '%s\\n' \"${COMPREPLY[@]}\"\n");
    return LinesOf("bash --norc " + (folder_ / "ask"));
  }
  std::vector<std::string> Fish(const std::string& line) {
    Write(folder_ / "ask", "cd " + folder_.path() + "; source script\ncomplete -C '" + line +
                               "' | string split -f1 \\t; true\n");
    return LinesOf("HOME=" + folder_.path() + " fish --no-config " + (folder_ / "ask"));
  }
  // zsh completes at its prompt alone: it gets one, and a widget that writes down what was added.
  std::vector<std::string> Zsh(const std::string& line) {
    Write(folder_ / "ask",
          "zmodload zsh/zpty\n"
          "zpty shell zsh -f -i\n"
          "zpty -w shell 'PS1=; cd " +
              folder_.path() +
              "; source ./inside'\n"
              "zpty -w shell $'\\C-u" +
              line +
              "\\t'\n"
              "repeat 300; do [ -f " +
              (folder_ / "done") +
              " ] && break; zpty -rt shell _ ||:; sleep 0.1; done\n"
              "zpty -d shell\n"
              "cat " +
              (folder_ / "offered") + "\n");
    Write(folder_ / "inside",
          "autoload -U compinit && compinit -u -D\n"
          "source ./script\n"
          "compadd() {\n"
          "  if [[ ${@[1,(i)(-|--)]} == *-(O|A|D)\\ * ]]; then builtin compadd \"$@\"; return $?; "
          "fi\n"
          "  local -a hits\n"
          "  builtin compadd -A hits -D _ \"$@\"\n"
          "  print -rl -- $hits >>offered\n"
          "  builtin compadd \"$@\"\n"
          "}\n"
          "finish() { : >>offered; zle expand-or-complete; : >done }\n"
          "zle -N finish\n"
          "bindkey '\\t' finish\n");
    fs::remove(folder_ / "done");
    fs::remove(folder_ / "offered");
    return LinesOf("zsh -f " + (folder_ / "ask"));
  }

  TempFolder folder_;
};

TEST_F(Completed, BashOffersCommandsOptionsWordsAndFiles) {
  if (!Exists("bash")) GTEST_SKIP() << "skipped: no bash";
  Ask("bash");
  EXPECT_THAT(Bash({"alidade", "loc"}), ElementsAre("localize"));
  EXPECT_THAT(Bash({"alidade", ""}),
              AllOf(Contains("run"), Contains("evaluate"), Not(Contains("man-pages"))));
  EXPECT_THAT(Bash({"alidade", "run", "--sem"}), ElementsAre("--semidense"));
  EXPECT_THAT(Bash({"alidade", "run", "wal"}), ElementsAre("walk.mp4"));
  EXPECT_THAT(Bash({"alidade", "run", "--sensor", ""}), ElementsAre("mono", "stereo", "rgbd"));
  EXPECT_THAT(Bash({"alidade", "run", "--sensor", "=", "st"}), ElementsAre("stereo"));
  EXPECT_THAT(Bash({"alidade", "run", "--sensor", "="}), ElementsAre("mono", "stereo", "rgbd"));
  EXPECT_THAT(Bash({"alidade", "run", "--rate", ""}), ElementsAre("realtime", "max"));
  EXPECT_THAT(Bash({"alidade", "run", "--set", "tracker.extractor.feat"}),
              ElementsAre("tracker.extractor.features="));
  EXPECT_THAT(Bash({"alidade", "run", "--set", "stream.picture_w"}),
              ElementsAre("stream.picture_width="));
  EXPECT_THAT(Bash({"alidade", "evaluate", "ate", "--ali"}), ElementsAre("--align"));
  EXPECT_THAT(Bash({"alidade", "evaluate", "rpe", "--pairs", "c"}), ElementsAre("consecutive"));
  EXPECT_THAT(Bash({"alidade", "run", "walk.mp4", "--config", "w"}), ElementsAre("walk.mp4"));
  // What nobody can guess is not guessed.
  EXPECT_THAT(Bash({"alidade", "run", "--seed", ""}), ElementsAre(""));
}

TEST_F(Completed, FishOffersCommandsOptionsWordsAndFiles) {
  if (!Exists("fish")) GTEST_SKIP() << "skipped: no fish";
  Ask("fish");
  EXPECT_THAT(Fish("alidade loc"), ElementsAre("localize"));
  EXPECT_THAT(Fish("alidade run --sem"), ElementsAre("--semidense"));
  EXPECT_THAT(Fish("alidade run wal"), ElementsAre("walk.mp4"));
  EXPECT_THAT(Fish("alidade run --sensor "),
              testing::UnorderedElementsAre("mono", "stereo", "rgbd"));
  EXPECT_THAT(Fish("alidade run --sensor=st"), ElementsAre("--sensor=stereo"));
  EXPECT_THAT(Fish("alidade run --set tracker.extractor.feat"),
              ElementsAre("tracker.extractor.features="));
  EXPECT_THAT(Fish("alidade evaluate ate --ali"), ElementsAre("--align"));
  EXPECT_THAT(Fish("alidade evaluate rpe --pairs c"), ElementsAre("consecutive"));
  EXPECT_THAT(Fish("alidade run --seed "), IsEmpty());
}

TEST_F(Completed, ZshOffersCommandsOptionsWordsAndFiles) {
  if (!Exists("zsh")) GTEST_SKIP() << "skipped: no zsh";
  Ask("zsh");
  EXPECT_THAT(Zsh("alidade loc"), Contains("localize"));
  EXPECT_THAT(Zsh("alidade run --sem"), Contains("--semidense"));
  EXPECT_THAT(Zsh("alidade run wal"), Contains("walk.mp4"));
  EXPECT_THAT(Zsh("alidade run --sensor "),
              AllOf(Contains("mono"), Contains("stereo"), Contains("rgbd")));
  EXPECT_THAT(Zsh("alidade run --set tracker.extractor.feat"),
              Contains("tracker.extractor.features="));
  EXPECT_THAT(Zsh("alidade evaluate rpe --pairs c"), Contains("consecutive"));
}

TEST(Completion, AnUnknownShellIsRefused) {
  const ProgramResult result = RunAlidade({"completion", "fihs"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean 'fish'"));
}

TEST(ManPages, ThereIsOneForEachCommandAndTheirReaderHasNothingToComplainOf) {
  const TempFolder folder;
  ASSERT_EQ(RunAlidade({"man-pages", folder.path()}).status, 0);
  const bool reader = Exists("groff");
  for (const std::vector<std::string>& command : {std::vector<std::string>{},
                                                  {"run"},
                                                  {"evaluate"},
                                                  {"evaluate", "ate"},
                                                  {"export"},
                                                  {"synth"}}) {
    std::string page = "alidade";
    std::vector<std::string> arguments = command;
    for (const std::string& word : command) page += "-" + word;
    ASSERT_TRUE(fs::exists(folder / (page + ".1"))) << page;
    if (!reader) continue;
    const auto lines = LinesOf("LC_ALL=C.UTF-8 groff -K utf8 -man -Tutf8 -ww -P-cbou -rLL=500n " +
                               (folder / (page + ".1")));
    std::string text;
    for (const std::string& line : lines) {
      EXPECT_THAT(line, Not(HasSubstr("warning:"))) << page;
      text += line + "\n";
    }
    // Every option that --help knows is in the page.
    arguments.push_back("--help");
    std::istringstream help(RunAlidade(arguments).out);
    int options = 0;
    for (std::string line; std::getline(help, line);) {
      const size_t start = line.find("--");
      if (line.rfind("  -", 0) != 0 || start == std::string::npos) continue;
      const std::string option = line.substr(start, line.find_first_of(" ,", start) - start);
      EXPECT_NE(text.find(option.substr(0, option.find('{'))), std::string::npos)
          << option << " is not in " << page;
      ++options;
    }
    EXPECT_GT(options, 0) << page;
  }
  if (!reader) GTEST_SKIP() << "skipped: no groff to read them with";
}

TEST(CommandLinePage, InTheDocumentationIsWhatTheProgramPrints) {
  const ProgramResult page = RunAlidade({"cli-page"});
  EXPECT_EQ(page.status, 0) << page.err;
  EXPECT_TRUE(page.out == ReadText(ALIDADE_DOCS "/reference/cli.md"))
      << "regenerate it: scripts/docs";
}

}  // namespace
}  // namespace alidade::completion_test
