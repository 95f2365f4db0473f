// alidade compare: several runs beside each other, as one HTML file.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/report/comparison.h"
#include "commands.h"

namespace alidade {
namespace {

struct CompareArguments {
  std::vector<std::string> results;
  std::string out = "compare.html";
};

// An earlier page gives way; anything else of that name is somebody's.
void CheckIsFree(const std::string& path) {
  CheckIsNoResult(path);
  if (!IsFile(path)) return;
  const std::string page = ReadFile(path);
  if (page.rfind("<!doctype html>", 0) == 0 && page.find(" runs compared</title>") < page.size())
    return;
  ThrowInput(
      path +
      " already exists and was not written by `alidade compare`: choose another file with --out");
}

int Compare(const CompareArguments& arguments) {
  CheckIsFree(arguments.out);
  std::vector<ComparedFolder> folders;
  for (const std::string& result : arguments.results) folders.push_back({result, ""});
  AtomicWriteFile(arguments.out, CompareResults(folders));
  std::printf("Comparison of %zu runs: %s\n", arguments.results.size(), arguments.out.c_str());
  return 0;
}

}  // namespace

void AddCompareCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("compare", "Write a page that compares several runs");
  auto arguments = std::make_shared<CompareArguments>();
  command->add_option("RESULT", arguments->results, "Result folders of `alidade run`, two or more")
      ->required()
      ->type_name("FOLDER");
  command->add_option("--out", arguments->out, "Page to write: a single HTML file")
      ->type_name("FILE")
      ->capture_default_str();
  command->footer(
      "\nExamples:\n  alidade compare alidade-out/kitchen alidade-out/kitchen-inline\n  alidade "
      "compare before after --out change.html\n\nErrors are shown if there is ground truth: "
      "groundtruth.txt in the result folder, or that of the recording.");
  command->callback([arguments, &action] { action = [arguments] { return Compare(*arguments); }; });
}

}  // namespace alidade
