// alidade batch: many recordings, each in a process and a folder of its own, and a table of all.
#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"
#include "alidade/run/batch_process.h"
#include "alidade/run/comparison.h"
#include "alidade/run/loop.h"
#include "arguments.h"
#include "batch_arguments.h"
#include "commands.h"
#include "run_flags.h"
#include "terminal.h"

namespace alidade {
namespace {

constexpr int kWorseStatus = 1;  // something failed, or got worse

// A line's words as `alidade run` reads them. Throws Error (usage) for what it would refuse.
RunOptions OptionsOf(const BatchItem& item) {
  RunOptions options;
  CLI::App run("", "alidade run");
  AddRunOptions(run, options);
  CheckNames(run, item.words);
  std::vector<std::string> words(item.words.rbegin(), item.words.rend());
  try {
    run.parse(words);
  } catch (const CLI::ParseError& error) {
    ThrowUsage(error.what());
  }
  if (options.source != SourceOf(item)) ThrowUsage("a line begins with its source");
  if (options.out) ThrowUsage("--out is for one line: all would have the same folder");
  if (options.viewer) ThrowUsage("--viewer shows one run; a batch is of many");
  CheckRunOptions(options);
  SourceOptionsFrom(options);
  RateFrom(options, ThreadedFrom(options, false));
  SettingsFrom(options);
  return options;
}

std::string ProgramMark() {
  const std::string program = ReadFile(OwnProgram());
  return std::to_string(program.size()) + ":" +
         std::to_string(std::hash<std::string>{}(program));
}

// Reads the whole list before anything is run.
std::vector<BatchWork> WorksOf(const BatchArguments& arguments) {
  const std::string mark = ProgramMark();
  std::vector<BatchWork> works;
  for (BatchItem& item :
       ParseBatchList(ReadFile(arguments.list), arguments.list, arguments.more)) {
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
  return done && done->status == 0 && done->fingerprint == work.fingerprint &&
         IsFile(folder.ResultOf(work.item) + "/stats.json");
}

// What a program said last, without "alidade: ".
std::string LastWords(const std::string& log) {
  if (!IsFile(log)) return "";
  std::string text = ReadFile(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::string line = text.substr(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  const std::string name = "alidade: ";
  return line.rfind(name, 0) == 0 ? line.substr(name.size()) : line;
}

std::string HowItEnded(const ProcessEnd& end, const std::string& log) {
  if (end.status == 0) return "";
  if (end.status == kInterruptedStatus) return "";
  if (end.status < 0) return "ended by signal " + std::to_string(-end.status);
  const std::string words = LastWords(log);
  return words.empty() ? "exit status " + std::to_string(end.status) : words;
}

// "100.0 % tracked, ATE 0.0123 m"
std::string Tracked(const BatchFolder& folder, const BatchItem& item) {
  const BatchRow row = RowOf(folder, item);
  if (!row.ok() || !row.coverage) return row.message.empty() ? row.state : row.message;
  char text[96];
  int length = std::snprintf(text, sizeof(text), "%.1f %% tracked", 100 * *row.coverage);
  if (row.ate) std::snprintf(text + length, sizeof(text) - length, ", ATE %.4f m", *row.ate);
  return text;
}

// One batch at a time in a folder.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder)
      : fd_(open((folder + "/done").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    errno = 0;
    if (fd_ >= 0 && !Occupy(fd_) && errno == EWOULDBLOCK)
      ThrowInput(folder + ": another `alidade batch` is at work there");
  }
  ~FolderLock() {
    if (fd_ >= 0) close(fd_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_;
};

int Cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

// Cores for each run: what Slurm gave, else its part of the machine.
int ThreadsOfOne(const BatchArguments& arguments, int jobs) {
  const char* given = arguments.only > 0 ? std::getenv("SLURM_CPUS_PER_TASK") : nullptr;
  if (given && std::atoi(given) > 0) return std::min(std::atoi(given), kMostThreads);
  if (arguments.only > 0 && std::getenv("SLURM_JOB_ID")) return 1;
  return std::clamp(Cores() / jobs, 1, kMostThreads);
}

// Runs what is not done. Each that ends is written down at once.
void RunWorks(const BatchArguments& arguments, BatchFolder& folder,
              const std::vector<BatchWork>& todo, size_t of_all) {
  const int jobs = arguments.jobs > 0 ? arguments.jobs : std::max(1, Cores() / 2);
  const std::string threads = std::to_string(ThreadsOfOne(arguments, jobs));
  std::vector<ProcessTask> tasks;
  for (const BatchWork& work : todo) {
    ProcessTask task{{OwnProgram(), "run"}, folder.LogOf(work.item)};
    const auto& words = work.item.words;
    task.words.insert(task.words.end(), words.begin(), words.end());
    task.words.insert(task.words.end(), {"--out", folder.ResultOf(work.item)});
    const bool own = std::any_of(words.begin(), words.end(), [](const std::string& word) {
      return word == "--threads" || word.rfind("--threads=", 0) == 0;
    });
    if (!own) task.words.insert(task.words.end(), {"--threads", threads});
    tasks.push_back(std::move(task));
  }
  Terminal terminal(false);
  Stopwatch clock;
  std::vector<std::string> running;
  size_t ended = 0;
  ProcessEvents events;
  events.begun = [&](size_t i) {
    folder.Forget(todo[i].item);
    folder.Note("begun", todo[i].item);
    running.push_back(todo[i].item.name);
  };
  events.ended = [&](size_t i, const ProcessEnd& end) {
    const BatchItem& item = todo[i].item;
    const std::string message = HowItEnded(end, folder.LogOf(item));
    folder.SetDone(item, {todo[i].fingerprint, end.status, end.wall_s, end.cpu_s, end.peak_mb,
                          message});
    folder.Note(end.status == 0                    ? "done"
                : end.status == kInterruptedStatus ? "interrupted"
                                                   : "failed",
                item);
    std::erase(running, item.name);
    terminal.SetProgress("");
    const std::string what = end.status == 0 ? Tracked(folder, item) : message;
    std::printf("[%zu/%zu] %s: %s (%.1f s)\n", of_all - todo.size() + ++ended, of_all,
                item.name.c_str(), what.empty() ? "interrupted" : what.c_str(), end.wall_s);
    std::fflush(stdout);
  };
  events.waiting = [&] {
    if (!terminal.shows_progress()) return;
    std::string line = std::to_string(of_all - todo.size() + ended) + " of " +
                       std::to_string(of_all) + " done, " +
                       std::to_string(static_cast<int>(1e-3 * clock.Milliseconds())) +
                       " s; running:";
    for (const std::string& name : running) line += " " + name;
    terminal.SetProgress(line);
  };
  RunProcesses(tasks, jobs, events);
}

// Rows of all, written as tables and as a page.
std::vector<BatchRow> Summarise(const BatchFolder& folder, const std::vector<BatchWork>& works) {
  std::vector<BatchRow> rows;
  std::vector<std::string> results;
  for (const BatchWork& work : works) {
    rows.push_back(RowOf(folder, work.item));
    if (rows.back().ok()) results.push_back(folder.ResultOf(work.item));
  }
  AtomicWriteFile(folder.path() + "/batch.json", BatchJson(rows));
  AtomicWriteFile(folder.path() + "/batch.md", BatchMarkdown(rows));
  try {
    if (results.size() >= 2)
      AtomicWriteFile(folder.path() + "/compare.html", CompareResults(results));
  } catch (const Error& error) {  // the tables are there
    std::printf("No compare.html: %s\n", error.what());
  }
  return rows;
}

// Their maps become one. False when that failed; what it says is shown.
bool MergeAll(const BatchFolder& folder, const std::vector<BatchRow>& rows) {
  ProcessTask task{{OwnProgram(), "merge"}, folder.path() + "/log/merged.txt"};
  for (const BatchRow& row : rows) {
    if (row.ok() && IsFile(folder.path() + "/" + row.name + "/map.alidade"))
      task.words.push_back(folder.path() + "/" + row.name);
  }
  if (task.words.size() < 4) {
    std::printf("Not merged: there are fewer than two maps\n");
    return true;
  }
  task.words.insert(task.words.end(), {"--out", folder.path() + "/merged"});
  int status = 0;
  ProcessEvents events;
  events.ended = [&](size_t, const ProcessEnd& end) { status = end.status; };
  RunProcesses({task}, 1, events);
  std::fputs(ReadFile(task.log).c_str(), stdout);
  return status == 0;
}

std::vector<BatchRow> ReadEarlier(const std::string& path) {
  const std::string file = IsFolder(path) ? path + "/batch.json" : path;
  return ParseBatchJson(ReadFile(file), file);
}

int RunOnly(const BatchArguments& arguments, BatchFolder& folder,
            const std::vector<BatchWork>& works) {
  if (arguments.only > static_cast<int>(works.size()))
    ThrowUsage("--only " + std::to_string(arguments.only) + ": the list has " +
               std::to_string(works.size()) + " recordings");
  const BatchWork& work = works[static_cast<size_t>(arguments.only) - 1];
  if (work.done) {
    std::printf("%s is done already\n", work.item.name.c_str());
    return 0;
  }
  RunWorks(arguments, folder, {work}, 1);
  const std::optional<BatchDone> done = folder.DoneOf(work.item);
  if (!done) return kInterruptedStatus;
  return done->status < 0 ? kWorseStatus : done->status;
}

int Batch(const BatchArguments& arguments) {
  CatchInterrupts();
  const std::optional<std::vector<BatchRow>> earlier =
      arguments.against.empty() ? std::nullopt : std::optional(ReadEarlier(arguments.against));
  std::vector<BatchWork> works = WorksOf(arguments);
  BatchFolder folder(arguments.out);
  std::vector<BatchWork> todo;
  for (BatchWork& work : works) {
    work.done = IsDone(folder, work);
    if (!work.done) todo.push_back(work);
  }
  if (arguments.only > 0) return RunOnly(arguments, folder, works);
  if (arguments.slurm) return SubmitToSlurm(arguments, folder, works);
  if (!arguments.table) {
    const FolderLock lock(folder.path());
    if (todo.size() < works.size())
      std::printf("%zu of %zu recordings are done already\n", works.size() - todo.size(),
                  works.size());
    RunWorks(arguments, folder, todo, works.size());
  }
  const std::vector<BatchRow> rows = Summarise(folder, works);
  std::printf("\n%s\n", BatchText(rows).c_str());
  const auto failed = std::count_if(rows.begin(), rows.end(),
                                    [](const BatchRow& row) { return row.state == "failed"; });
  const auto waiting = std::count_if(rows.begin(), rows.end(), [](const BatchRow& row) {
    return row.state == "waiting" || row.state == "interrupted";
  });
  std::printf("%zu recordings, %td failed", rows.size(), failed);
  if (waiting > 0) std::printf(", %td not done: the same command goes on with them", waiting);
  std::printf("; tables in %s\n", folder.path().c_str());
  if (Interrupted()) return kInterruptedStatus;
  bool good = failed == 0 && waiting == 0;
  if (arguments.merge) good = MergeAll(folder, rows) && good;
  if (earlier) {
    const std::vector<std::string> worse = WorseThan(*earlier, rows, arguments.worse);
    for (const std::string& line : worse) std::printf("worse: %s\n", line.c_str());
    if (worse.empty()) std::printf("Nothing got worse than in %s\n", arguments.against.c_str());
    good = good && worse.empty();
  }
  return good ? 0 : kWorseStatus;
}

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
    "  alidade batch list.txt --out all --slurm --merge           on a cluster, one map at the end\n"
    "\nWhat is done (same words, files and program) is not done again: after Ctrl-C the same "
    "command goes on.\nLeaves a folder for each, batch.json, batch.md and compare.html in --out "
    "(docs/batch.md). For times that compare: --jobs 1.\n"
    "Exit status 1: something failed or got worse.";

// An option that says how much worse a figure may get.
void AddWorse(CLI::App& command, const std::string& name, BatchArguments& arguments,
              WorseBy& by, const std::string& what,
              const std::vector<std::pair<std::string, double>>& units) {
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
  AddWorse(command, "--worse-ms", a, a.worse.ms, "Median time of a frame: %, ms (off)", {{"ms", 1}});
  AddWorse(command, "--worse-cpu", a, a.worse.cpu, "Processor time: %, s (off)", {{"s", 1}});
  AddWorse(command, "--worse-memory", a, a.worse.memory, "Peak memory: %, MB (off)", {{"MB", 1}});
}

}  // namespace

std::string OwnProgram() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) ThrowInput("this program does not find itself: " + error.message());
  return path.string();
}

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
                   "Folder of an earlier batch: what got worse is told, and is status 1")
      ->type_name("DIR");
  command->add_flag("--merge", arguments->merge,
                    "Then make one map of all, as `alidade merge` does, in merged/");
  command->add_flag("--table", arguments->table, "Run nothing: make the table of what is done");
  command
      ->add_option("--only", arguments->only, "Run the Nth recording of the list, no table")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  AddWorseOptions(*command, *arguments);
  command->add_flag("--slurm", arguments->slurm,
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
