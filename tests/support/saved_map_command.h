// The map of a short run, for tests of commands that read it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/rendered.h"

namespace alidade {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class SavedMapCommand : public testing::Test {
 protected:
  // Folder of a short run with lens distortion.
  static std::string Result(const std::string& sensor) {
    const std::string recording = Rendered({"room", "--frames", "40", "--distortion"});
    const std::string out = recording + "." + sensor;
    if (fs::exists(out)) return out;
    const std::string draft = out + "." + std::to_string(getpid());
    const ProgramResult run =
        RunAlidade({"run", recording, "--sensor", sensor, "--out", draft, "--quiet"});
    EXPECT_EQ(run.status, 0) << run.err;
    std::error_code taken;  // another test process made the same map
    fs::rename(draft, out, taken);
    if (taken) fs::remove_all(draft);
    return out;
  }
  static json Info(const std::string& map) {
    const ProgramResult info = RunAlidade({"info", map, "--json"});
    EXPECT_EQ(info.status, 0) << info.err;
    return json::parse(info.out, nullptr, false);
  }
  void Export(const std::string& map, const std::string& to, const std::string& out,
              const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments = {"export", map, "--to", to, out};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(LineCount(result.out), 1);
  }
  void ExpectRefused(const std::vector<std::string>& arguments, int status,
                     const std::string& words) {
    const ProgramResult result = RunAlidade(arguments);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(LineCount(result.err), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
  std::vector<std::string> NamesIn(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }
  TempFolder folder_;
};

}  // namespace alidade
