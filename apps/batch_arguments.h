// What `alidade batch` is asked to do.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/batch/batch_state.h"
#include "alidade/run/batch/batch_table.h"

namespace alidade {

struct BatchArguments {
  std::string list, out;
  std::vector<std::string> more;  // options for every line
  int jobs = 0;                   // 0: one for every two cores
  std::string against;            // folder of an earlier batch, or its batch.json
  bool merge = false;
  bool table = false;  // run nothing
  int only = 0;        // the one line to run, from 1; 0: all
  bool slurm = false, wait = false;
  std::string sbatch;  // options for it
  WorseSettings worse;
  std::vector<std::string> worse_words;  // the options that made it
};

struct BatchWork {
  BatchItem item;
  std::string fingerprint;
  bool done = false;  // already, by the same program, from the same files
};

// Runs, tells and writes all of it; the exit status.
int Batch(const BatchArguments& arguments);

// The whole list, before anything is run. Throws Error, naming the line, for what `alidade run`
// would refuse (usage), and for what cannot be read (input).
std::vector<BatchWork> WorksOf(const BatchArguments& arguments);

// By this program, from the same files.
bool IsDone(const BatchFolder& folder, const BatchWork& work);

std::string OwnProgram();  // path of this executable

// Writes the scripts of a Slurm array of what is not done, and of the job that makes the table once
// all of it has ended, and submits both. Returns the exit status. Throws Error (input) when Slurm
// is not there or refuses.
int SubmitToSlurm(const BatchArguments& arguments, const BatchFolder& folder,
                  const std::vector<BatchWork>& works);

}  // namespace alidade
