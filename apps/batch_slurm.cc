// A batch as jobs of Slurm: an array with a task for each recording, and one that makes the table.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "batch_arguments.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

// For a POSIX shell.
std::string ForShell(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

struct CommandEnd {
  int status = -1;
  std::string out;
};

CommandEnd OutputOf(const std::string& command) {
  CommandEnd end;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) ThrowInput("cannot start a shell");
  std::array<char, 4096> buffer{};
  size_t size = 0;
  while ((size = fread(buffer.data(), 1, buffer.size(), pipe)) > 0)
    end.out.append(buffer.data(), size);
  const int state = pclose(pipe);
  end.status = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  return end;
}

// Its number: "123" of "123;cluster". Empty with the status when sbatch failed.
std::string JobOf(const CommandEnd& end) { return end.out.substr(0, end.out.find_first_of(";\n")); }

// "1-4,7" of 1, 2, 3, 4, 7.
std::string RangesOf(const std::vector<size_t>& numbers) {
  std::string ranges;
  for (size_t i = 0; i < numbers.size();) {
    size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    ranges += (ranges.empty() ? "" : ",") + std::to_string(numbers[i]);
    if (last > i) ranges += "-" + std::to_string(numbers[last]);
    i = last + 1;
  }
  return ranges;
}

std::string Script(const std::string& directives, const std::string& command) {
  return "#!/bin/sh\n# Written by `alidade batch --slurm`.\n" + directives + "cd " +
         ForShell(fs::current_path().string()) + " || exit 1\nexec " + command + "\n";
}

}  // namespace

int SubmitToSlurm(const BatchArguments& arguments, const BatchFolder& folder,
                  const std::vector<BatchWork>& works) {
  if (OutputOf("command -v sbatch").status != 0)
    ThrowInput("sbatch was not found: --slurm needs Slurm (Debian: slurm-client)");
  const std::string out = fs::absolute(folder.path()).string();
  const std::string slurm = out + "/slurm";
  std::error_code error;
  fs::create_directories(slurm, error);
  if (error) ThrowInput(slurm + ": cannot be created: " + error.message());
  // The list as it is now: who changes it later changes no job.
  std::string list;  // line N is task N
  std::vector<size_t> tasks;
  for (size_t i = 0; i < works.size(); ++i) {
    list += LineOf(works[i].item) + "\n";
    if (!works[i].done) tasks.push_back(i + 1);
  }
  AtomicWriteFile(slurm + "/list.txt", list);
  const std::string batch = ForShell(OwnProgram()) + " batch " + ForShell(slurm + "/list.txt") +
                            " --out " + ForShell(out);
  const std::string at_once = arguments.jobs > 0 ? "%" + std::to_string(arguments.jobs) : "";
  std::string table = batch + " --table";
  if (arguments.merge) table += " --merge";
  if (!arguments.against.empty())
    table += " --against " + ForShell(fs::absolute(arguments.against).string());
  for (const std::string& option : arguments.worse_words) table += " " + ForShell(option);
  AtomicWriteFile(slurm + "/array.sh", Script("#SBATCH --job-name=alidade\n#SBATCH --requeue\n"
                                              "#SBATCH --open-mode=append\n",
                                              batch + " --only \"$SLURM_ARRAY_TASK_ID\""));
  AtomicWriteFile(slurm + "/table.sh", Script("#SBATCH --job-name=alidade-table\n", table));

  std::string after;
  if (!tasks.empty()) {
    const CommandEnd array = OutputOf("sbatch --parsable --array=" + RangesOf(tasks) + at_once +
                                      " --output=" + ForShell(out + "/log/slurm-%A_%a.txt") + " " +
                                      arguments.sbatch + " " + ForShell(slurm + "/array.sh"));
    const std::string job = JobOf(array);
    if (array.status != 0 || job.empty()) ThrowInput("sbatch refused the job array (see above)");
    std::printf("%zu of %zu recordings submitted as job array %s\n", tasks.size(), works.size(),
                job.c_str());
    std::fflush(stdout);
    after = " --dependency=afterany:" + job;
  }
  const CommandEnd end = OutputOf("sbatch --parsable" + after + (arguments.wait ? " --wait" : "") +
                                  " --output=" + ForShell(out + "/log/slurm-table.txt") + " " +
                                  arguments.sbatch + " " + ForShell(slurm + "/table.sh"));
  const std::string job = JobOf(end);
  if (job.empty()) ThrowInput("sbatch refused the job that writes the table (see above)");
  if (!arguments.wait) {
    std::printf("Job %s writes the table %s/batch.md when all have ended\n", out.c_str(),
                job.c_str());
    return 0;
  }
  std::fputs(ReadFile(out + "/log/slurm-table.txt").c_str(), stdout);
  return end.status;
}

}  // namespace alidade
