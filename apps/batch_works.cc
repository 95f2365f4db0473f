// Reads the list of a batch, with the options of each line.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/folder/earlier_result.h"
#include "alidade/run/play/loop.h"
#include "batch_arguments.h"
#include "old_forms.h"
#include "program/arguments.h"
#include "run/run_flags.h"

namespace alidade {
namespace {

// Parses the words of a line as `alidade run` does, and replaces old forms among them. Throws Error
// (usage) for invalid ones.
RunOptions OptionsOf(BatchItem& item) {
  RunOptions options;
  CLI::App run("", "alidade run");
  AddRunOptions(run, options);
  item.words = WithoutOldForms(run, std::move(item.words));
  CheckNames(run, item.words);
  std::vector<std::string> words(item.words.rbegin(), item.words.rend());
  try {
    run.parse(words);
  } catch (const CLI::ParseError& error) {
    ThrowUsage(error.what());
  }
  if (options.source != SourceOf(item)) ThrowUsage("each line must begin with a source");
  if (options.out) ThrowUsage("--out cannot be given for all lines, which would share the folder");
  if (options.viewer) ThrowUsage("--viewer shows a single run and cannot be used in a batch");
  CheckRunOptions(options);
  SourceOptionsFrom(options);
  RateFrom(options, ThreadedFrom(options, false), false);
  SettingsFrom(options);
  return options;
}

std::string ProgramMark() {
  const std::string program = ReadFile(OwnProgram());
  return std::to_string(program.size()) + ":" + std::to_string(std::hash<std::string>{}(program));
}

}  // namespace

std::vector<BatchWork> WorksOf(const BatchArguments& arguments) {
  const std::string mark = ProgramMark();
  std::vector<BatchWork> works;
  const auto is_others = [&](const std::string& name, const std::string& source) {
    return IsTakenFrom(ReadEarlierResult(arguments.out + "/" + name + "/stats.json"),
                       OwnerOf(source, false));
  };
  for (BatchItem& item :
       ParseBatchList(ReadFile(arguments.list), arguments.list, arguments.more, is_others)) {
    try {
      const RunOptions options = OptionsOf(item);
      BatchWork work;
      work.fingerprint = FingerprintOf(item, options, mark);
      work.item = std::move(item);
      works.push_back(std::move(work));
    } catch (const Error& error) {
      throw Error(error.kind(),
                  arguments.list + ":" + std::to_string(item.line) + ": " + error.what());
    }
  }
  return works;
}

bool IsDone(const BatchFolder& folder, const BatchWork& work) {
  const std::optional<BatchDone> done = folder.DoneOf(work.item);
  if (!done || done->status != 0 || done->fingerprint != work.fingerprint) return false;
  // Another run may have written to the folder since.
  const auto result = ReadEarlierResult(folder.ResultOf(work.item) + "/stats.json");
  return result && result->complete && result->owner.source == SourceOf(work.item);
}

std::string OwnProgram() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) ThrowInput("cannot find the path of this program: " + error.message());
  // The path of a program that was replaced meanwhile; the system may append " (deleted)".
  const std::string name = path.string(), gone = " (deleted)";
  const bool replaced = name.size() > gone.size() && name.ends_with(gone);
  return replaced ? name.substr(0, name.size() - gone.size()) : name;
}

}  // namespace alidade
