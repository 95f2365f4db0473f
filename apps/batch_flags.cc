// The command line of `alidade batch`.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/run/setup/options.h"
#include "batch_arguments.h"
#include "commands.h"

namespace alidade {
namespace {

constexpr char kFooter[] =
    "\nLIST has a recording per line, with options as after `alidade run`, and # comments:\n"
    "  # name of the folder of results: --out, else as the source is called\n"
    "  $DATA/fr1_desk --sensor mono\n"
    "  $DATA/kitchen --last 299 --out kitchen_a\n"
    "  synth:room?frames=100&seed=3\n"
    "\nExamples:\n"
    "  alidade batch list.txt --out monday\n"
    "  alidade batch list.txt --out phone -- --profile phone      for every line\n"
    "  alidade batch list.txt --out tuesday --against monday      status 1 if anything got worse\n"
    "  alidade batch list.txt --out all --slurm --merge           on a cluster, one map at the "
    "end\n"
    "\nWhat is done (same words, files and program) is not done again: after Ctrl-C the same "
    "command goes on.\nLeaves a folder for each, batch.json, batch.md and compare.html in --out "
    "(docs/guides/batch.md). For times that compare: --jobs 1.\n"
    "Exit status 1: something failed or got worse.";

// An option that says how much worse a figure may get.
void AddWorse(CLI::App& command, const std::string& name, BatchArguments& arguments, WorseBy& by,
              const std::string& what, const std::vector<std::pair<std::string, double>>& units) {
  command
      .add_option_function<std::string>(
          name,
          [name, &by, &arguments, units](const std::string& text) {
            by = ParseWorseBy(name, text, units);
            arguments.worse_words.insert(arguments.worse_words.end(), {name, text});
          },
          what)
      ->type_name("BY")
      ->group("What is worse (with --against)");
}

void AddWorseOptions(CLI::App& command, BatchArguments& a) {
  const std::vector<std::pair<std::string, double>> length = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
  AddWorse(command, "--worse-ate", a, a.worse.ate, "ATE, in % of what it was, or mm, cm, m (10%)",
           length);
  AddWorse(command, "--worse-rpe", a, a.worse.rpe, "RPE of one second, the same (off)", length);
  AddWorse(command, "--worse-coverage", a, a.worse.coverage,
           "Fewer frames tracked: points (of 100 frames), or % of what it was (1points)",
           {{"points", 0.01}, {"point", 0.01}});
  AddWorse(command, "--worse-ms", a, a.worse.ms, "Median time of a frame: %, ms (off)",
           {{"ms", 1}});
  AddWorse(command, "--worse-cpu", a, a.worse.cpu, "Processor time: %, s (off)", {{"s", 1}});
  AddWorse(command, "--worse-memory", a, a.worse.memory, "Peak memory: %, MB (off)", {{"MB", 1}});
}

}  // namespace

void AddBatchCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("batch", "Run many recordings, here or on a cluster; a table of all");
  auto arguments = std::make_shared<BatchArguments>();
  command->add_option("LIST", arguments->list, "Text file, a recording per line (below)")
      ->required()
      ->type_name("FILE");
  command->add_option("OPTIONS", arguments->more, "After --: options of `run` for every line");
  command->add_option("--out", arguments->out, "Folder for all results")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--jobs", arguments->jobs,
                   "Recordings at a time (one for every two cores; with --slurm: no limit)")
      ->check(CLI::Range(1, kMostThreads))
      ->type_name("N");
  command
      ->add_option("--against", arguments->against,
                   "Folder of an earlier batch: what got worse is told, and is status 1; "
                   "compare.html shows both")
      ->type_name("DIR");
  command->add_flag("--merge", arguments->merge,
                    "Then make one map of all, as `alidade merge` does, in merged/");
  command->add_flag("--table", arguments->table, "Run nothing: make the table of what is done");
  command->add_option("--only", arguments->only, "Run the Nth recording of the list, no table")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  AddWorseOptions(*command, *arguments);
  command
      ->add_flag("--slurm", arguments->slurm,
                 "Submit an array of jobs to Slurm, and a job that makes the table after it")
      ->group("Slurm");
  command
      ->add_option("--sbatch", arguments->sbatch,
                   "Options for sbatch, in one word: \"--partition=long --cpus-per-task=4\"")
      ->group("Slurm")
      ->type_name("OPTIONS");
  command->add_flag("--wait", arguments->wait, "Wait for all of it, show the table")
      ->group("Slurm");
  command->footer(kFooter);
  command->callback([arguments, &action] {
    if (!arguments->slurm && (arguments->wait || !arguments->sbatch.empty()))
      ThrowUsage("--wait and --sbatch go with --slurm");
    if (arguments->table && arguments->slurm)
      ThrowUsage("--table makes the table here, --slurm submits jobs: one of them");
    action = [arguments] { return Batch(*arguments); };
  });
}

}  // namespace alidade
