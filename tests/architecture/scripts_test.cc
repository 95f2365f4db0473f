// Every script says what it does before it does anything, and refuses options it does not have.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

namespace scripts_test {
namespace {

namespace fs = std::filesystem;

struct ScriptResult {
  int status = -1;
  std::string said;
};

// Scripts are copied into a folder of their own, and find no programs but those that can do no
// harm.
class Scripts : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "alidade-scripts-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    fs::create_directories(folder_ / "tree/web");
    Copy(fs::path(ALIDADE_SOURCE_DIR) / "scripts", folder_ / "tree/scripts");
    fs::create_directory(folder_ / "bin");
    for (const char* program : {"env", "bash", "sh", "sed", "basename", "dirname", "python3"}) {
      for (const char* place : {"/bin", "/usr/bin", "/usr/local/bin"}) {
        std::error_code taken;
        if (fs::exists(fs::path(place) / program))
          fs::create_symlink(fs::path(place) / program, folder_ / "bin" / program, taken);
      }
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Without what npm installs for the linters.
  static void Copy(const fs::path& from, const fs::path& to) {
    fs::create_directories(to);
    for (const auto& entry : fs::directory_iterator(from)) {
      const fs::path name = entry.path().filename();
      if (!entry.is_directory()) {
        fs::copy_file(entry.path(), to / name);
      } else if (name != "node_modules") {
        Copy(entry.path(), to / name);
      }
    }
  }

  // Paths below scripts/ of everything a person runs; not what another script runs elsewhere.
  std::vector<std::string> Names() {
    std::vector<std::string> names;
    const fs::path scripts = folder_ / "tree/scripts";
    for (const auto& entry : fs::recursive_directory_iterator(scripts)) {
      const bool runs = (entry.status().permissions() & fs::perms::owner_exec) != fs::perms::none;
      const std::string name = fs::relative(entry.path(), scripts);
      const bool inner = name == "package/use-packages" || name.starts_with("tools/");
      if (entry.is_regular_file() && runs && !inner) names.push_back(name);
    }
    return names;
  }
  ScriptResult Run(const std::string& name, const std::string& argument) {
    const std::string command =
        "cd " + (folder_ / "tree").string() + " && PATH=" + (folder_ / "bin").string() +
        " PYTHONDONTWRITEBYTECODE=1 scripts/" + name + " " + argument + " </dev/null >../said 2>&1";
    const int state = std::system(command.c_str());
    std::ifstream file(folder_ / "said");
    return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, {std::istreambuf_iterator<char>(file), {}}};
  }
  std::set<std::string> Tree() {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "tree"))
      all.insert(entry.path());
    return all;
  }

  fs::path folder_;
};

TEST_F(Scripts, SayWhatTheyDoAndDoNothing) {
  const std::set<std::string> before = Tree();
  for (const std::string& name : Names()) {
    for (const char* argument : {"--help", "-h"}) {
      const ScriptResult result = Run(name, argument);
      EXPECT_EQ(result.status, 0) << name << ": " << result.said;
      EXPECT_GT(result.said.size(), 20u) << name;
      EXPECT_EQ(result.said.find("not found"), std::string::npos) << name << ": " << result.said;
    }
  }
  EXPECT_EQ(Tree(), before);
}

TEST_F(Scripts, RefuseAnOptionTheyDoNotHave) {
  const std::set<std::string> before = Tree();
  for (const std::string& name : Names()) {
    if (name == "cluster/slurm-local") continue;  // its arguments are any command
    const ScriptResult result = Run(name, "--no-such-option");
    EXPECT_EQ(result.status, 2) << name << ": " << result.said;
    EXPECT_NE(result.said, "") << name;
  }
  EXPECT_EQ(Tree(), before);
}

}  // namespace
}  // namespace scripts_test
