// alidade batch: runs many recordings, each in its own process and folder, and tabulates the
// results.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <sstream>
#include <thread>

#include "alidade/base/error.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/file.h"
#include "alidade/run/batch/batch_compare.h"
#include "alidade/run/batch/batch_merge.h"
#include "alidade/run/batch/batch_process.h"
#include "alidade/run/folder/folder_lock.h"
#include "alidade/run/play/loop.h"
#include "batch_arguments.h"
#include "program/terminal.h"

namespace alidade {
namespace {

constexpr int kWorseStatus = 1;  // a recording failed or got worse

// Reason of a failure: the last "alidade: …" line that is not a warning, else the last line.
std::string LastWords(const std::string& log) {
  if (!IsFile(log)) return "";
  std::istringstream lines(ReadFile(log));
  std::string last, why;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("alidade: ", 0) == 0 && line.rfind("alidade: warning: ", 0) != 0)
      why = line.substr(9);
    if (!line.empty()) last = line;
  }
  return why.empty() ? last : why;
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

int Cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

// Cores for each run: those given by Slurm, else an equal share of the machine.
int ThreadsOfOne(const BatchArguments& arguments, int jobs) {
  const char* given = arguments.only > 0 ? std::getenv("SLURM_CPUS_PER_TASK") : nullptr;
  if (given && std::atoi(given) > 0) return std::min(std::atoi(given), kMostThreads);
  if (arguments.only > 0 && std::getenv("SLURM_JOB_ID")) return 1;
  return std::clamp(Cores() / jobs, 1, kMostThreads);
}

// Runs the remaining recordings and stores each result as soon as it is there.
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
    folder.SetDone(item,
                   {todo[i].fingerprint, end.status, end.wall_s, end.cpu_s, end.peak_mb, message});
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
    std::string line =
        std::to_string(of_all - todo.size() + ended) + " of " + std::to_string(of_all) + " done, " +
        std::to_string(static_cast<int>(1e-3 * clock.Milliseconds())) + " s; running:";
    for (const std::string& name : running) line += " " + name;
    terminal.SetProgress(line);
  };
  RunProcesses(tasks, jobs, events);
}

// Writes the rows as tables and as a page, which also shows the earlier batch (may be null).
std::vector<BatchRow> Summarise(const BatchFolder& folder, const std::vector<BatchWork>& works,
                                const EarlierBatch* earlier) {
  std::vector<BatchRow> rows;
  rows.reserve(works.size());
  for (const BatchWork& work : works) rows.push_back(RowOf(folder, work.item));
  AtomicWriteFile(folder.path() + "/batch.json", BatchJson(rows));
  AtomicWriteFile(folder.path() + "/batch.md", BatchMarkdown(rows));
  try {
    const BatchComparison page = RunsToCompare(folder.path(), rows, earlier);
    for (const std::string& line : page.missing)
      std::printf("Not compared in compare.html: %s\n", line.c_str());
    if (page.runs.size() >= 2)
      AtomicWriteFile(folder.path() + "/compare.html", CompareResults(page.runs));
  } catch (const Error& error) {  // the tables are there
    std::printf("compare.html was not written: %s\n", error.what());
  }
  return rows;
}

// Merges the maps that can be merged, each group into a folder of its own, and prints why others
// cannot. Returns false, with a message, if merging failed.
bool MergeAll(const BatchFolder& folder, const std::vector<BatchRow>& rows) {
  std::vector<std::string> maps;
  for (const BatchRow& row : rows) {
    if (row.ok() && IsFile(folder.path() + "/" + row.name + "/map.alidade"))
      maps.push_back(folder.path() + "/" + row.name);
  }
  const MergePlan plan = PlanMerge(maps);
  for (const std::string& why : plan.left_out) std::printf("Not merged: %s\n", why.c_str());
  if (plan.groups.empty())
    std::printf("Nothing to merge: there are no two maps of one sensor and camera\n");
  bool good = true;
  for (size_t i = 0; i < plan.groups.size(); ++i) {
    const std::string name = MergedName(i);
    ProcessTask task{{OwnProgram(), "merge"}, folder.path() + "/log/" + name + ".txt"};
    task.words.insert(task.words.end(), plan.groups[i].begin(), plan.groups[i].end());
    task.words.insert(task.words.end(), {"--out", folder.path() + "/" + name, "--overwrite"});
    ProcessEvents events;
    events.ended = [&](size_t, const ProcessEnd& end) { good = good && end.status == 0; };
    RunProcesses({task}, 1, events);
    std::fputs(ReadFile(task.log).c_str(), stdout);
  }
  return good;
}

int RunOnly(const BatchArguments& arguments, BatchFolder& folder,
            const std::vector<BatchWork>& works) {
  if (arguments.only > static_cast<int>(works.size()))
    ThrowUsage("--only " + std::to_string(arguments.only) + ": the list has only " +
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

}  // namespace

int Batch(const BatchArguments& arguments) {
  CatchInterrupts();
  const std::optional<EarlierBatch> earlier =
      arguments.against.empty() ? std::nullopt : std::optional(ReadEarlierBatch(arguments.against));
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
    const FolderLock lock(folder.path() + "/batch.lock", folder.path() + ": ");
    if (todo.size() < works.size())
      std::printf("%zu of %zu recordings are done already\n", works.size() - todo.size(),
                  works.size());
    RunWorks(arguments, folder, todo, works.size());
  }
  const std::vector<BatchRow> rows = Summarise(folder, works, earlier ? &*earlier : nullptr);
  std::printf("\n%s\n", BatchText(rows).c_str());
  const auto failed = std::count_if(rows.begin(), rows.end(),
                                    [](const BatchRow& row) { return row.state == "failed"; });
  const auto waiting = std::count_if(rows.begin(), rows.end(), [](const BatchRow& row) {
    return row.state == "waiting" || row.state == "interrupted";
  });
  std::printf("%zu recordings, %td failed", rows.size(), failed);
  if (waiting > 0) std::printf(", %td not done: the same command continues with them", waiting);
  std::printf("; tables in %s\n", folder.path().c_str());
  if (Interrupted()) return kInterruptedStatus;
  bool good = failed == 0 && waiting == 0;
  if (arguments.merge) good = MergeAll(folder, rows) && good;
  if (earlier) {
    const std::vector<std::string> worse = WorseThan(earlier->rows, rows, arguments.worse);
    for (const std::string& line : worse) std::printf("worse: %s\n", line.c_str());
    if (worse.empty()) std::printf("No result is worse than in %s\n", arguments.against.c_str());
    good = good && worse.empty();
  }
  return good ? 0 : kWorseStatus;
}

}  // namespace alidade
