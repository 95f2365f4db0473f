// Options that several benchmarks have.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace alidade::bench {

inline void AddOut(CLI::App& command, std::string& out) {
  command.add_option("--out", out, "JSON file to write the figures to")->type_name("FILE");
}

inline CLI::Option* AddFrames(CLI::App& command, int& frames, const std::string& help) {
  return command.add_option("--frames", frames, help)->check(CLI::Range(2, 100000000));
}

inline void AddRecordings(CLI::App& command, std::vector<std::string>& recordings,
                          const std::string& help) {
  command.add_option("RECORDING", recordings, help)->type_name("PATH");
}

// An option that is given again for each value.
inline CLI::Option* AddMany(CLI::App& command, const std::string& name,
                            std::vector<std::string>& values, const std::string& help) {
  return command.add_option(name, values, help)
      ->take_all()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

inline void AddSettings(CLI::App& command, std::vector<std::string>& settings) {
  AddMany(command, "--set", settings, "One setting of all runs")->type_name("NAME=VALUE");
}

inline void AddSeeds(CLI::App& command, int& seeds, const std::string& help) {
  command.add_option("--seeds", seeds, help)->check(CLI::Range(1, 100))->capture_default_str();
}

}  // namespace alidade::bench
