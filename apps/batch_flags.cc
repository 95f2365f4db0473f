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
    "\nEach line of LIST is a recording, with options of `alidade run`; # begins a comment:\n  # "
    "the result folder is named by --out, else after the source\n  $DATA/fr1_desk --sensor mono\n  "
    "$DATA/kitchen --last 299 --out kitchen_a\n  synth:room?frames=100&seed=3\n\nExamples:\n  "
    "alidade batch list.txt --out monday\n  alidade batch list.txt --out phone -- --profile phone  "
    "    an option for all lines\n  alidade batch list.txt --out tuesday --against monday      "
    "status 1 if anything got worse\n  alidade batch list.txt --out all --slurm --merge           "
    "on a cluster, with one map at the end\n\nA recording is not run again if its options, files "
    "and the program are unchanged: after Ctrl-C the same command\ncontinues. Writes a folder for "
    "each recording, batch.json, batch.md and compare.html to --out\n(docs/guides/batch.md). Times "
    "are comparable with --jobs 1 only.\nExit status 1: a recording failed, or a result got worse.";

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
      ->group("Tolerances (with --against)");
}

void AddWorseOptions(CLI::App& command, BatchArguments& a) {
  const std::vector<std::pair<std::string, double>> length = {{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
  AddWorse(command, "--worse-ate", a, a.worse.ate,
           "Tolerated increase of the ATE: %, mm, cm, m or off; default: 10%", length);
  AddWorse(command, "--worse-rpe", a, a.worse.rpe,
           "Tolerated increase of the RPE over one second: %, mm, cm, m or off; default: off",
           length);
  AddWorse(command, "--worse-coverage", a, a.worse.coverage,
           "Tolerated decrease of the share of tracked frames: points (percentage points), % or "
           "off; default: 1points",
           {{"points", 0.01}, {"point", 0.01}});
  AddWorse(command, "--worse-ms", a, a.worse.ms,
           "Tolerated increase of the median time per frame: %, ms or off; default: off",
           {{"ms", 1}});
  AddWorse(command, "--worse-cpu", a, a.worse.cpu,
           "Tolerated increase of the processor time: %, s or off; default: off", {{"s", 1}});
  AddWorse(command, "--worse-memory", a, a.worse.memory,
           "Tolerated increase of the peak memory: %, MB or off; default: off", {{"MB", 1}});
}

}  // namespace

void AddBatchCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "batch", "Run many recordings, on this machine or a cluster, and tabulate the results");
  auto arguments = std::make_shared<BatchArguments>();
  command->add_option("LIST", arguments->list, "Text file with one recording per line (see below)")
      ->required()
      ->type_name("FILE");
  command->add_option("OPTIONS", arguments->more, "After --: options of `run` for all lines");
  command->add_option("--out", arguments->out, "Folder for all results")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--jobs", arguments->jobs,
                   "Recordings processed at the same time; default: one per two cores, with "
                   "--slurm no limit")
      ->check(CLI::Range(1, kMostThreads))
      ->type_name("N");
  command
      ->add_option("--against", arguments->against,
                   "Folder of an earlier batch to compare with: prints what got worse, with exit "
                   "status 1; compare.html shows both")
      ->type_name("DIR");
  command->add_flag("--merge", arguments->merge,
                    "Afterwards merge all maps into merged/, as `alidade merge` does");
  command->add_flag("--table", arguments->table,
                    "Run nothing; only write the table of the results so far");
  command
      ->add_option("--only", arguments->only,
                   "Run only the Nth recording of the list, and write no table")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  AddWorseOptions(*command, *arguments);
  command
      ->add_flag("--slurm", arguments->slurm,
                 "Submit the recordings to Slurm as a job array, and a job that writes the table "
                 "afterwards")
      ->group("Slurm");
  command
      ->add_option("--sbatch", arguments->sbatch,
                   "Options for sbatch, in quotes: \"--partition=long --cpus-per-task=4\"")
      ->group("Slurm")
      ->type_name("OPTIONS");
  command
      ->add_flag("--wait", arguments->wait, "Wait until all jobs have ended, and print the table")
      ->group("Slurm");
  command->footer(kFooter);
  command->callback([arguments, &action] {
    if (!arguments->slurm && (arguments->wait || !arguments->sbatch.empty()))
      ThrowUsage("--wait and --sbatch require --slurm");
    if (arguments->table && arguments->slurm)
      ThrowUsage(
          "--table cannot be combined with --slurm, which writes the table in a job of its own");
    action = [arguments] { return Batch(*arguments); };
  });
}

}  // namespace alidade
