// Arguments of `alidade batch`.
#pragma once

#include <string>
#include <vector>

#include "alidade/run/batch/batch_state.h"
#include "alidade/run/batch/batch_table.h"

namespace alidade {

struct BatchArguments {
  std::string list, out;
  std::vector<std::string> more;  // options for all lines
  int jobs = 0;                   // 0: one per two cores
  std::string against;            // folder of an earlier batch, or its batch.json
  bool merge = false;
  bool table = false;  // only write the table
  int only = 0;        // number of the only line to run, from 1; 0: all
  bool slurm = false, wait = false;
  std::string sbatch;  // options of sbatch
  WorseSettings worse;
  std::vector<std::string> worse_words;  // the options as typed
};

struct BatchWork {
  BatchItem item;
  std::string fingerprint;
  bool done = false;  // already, with the same program and files
};

// Runs the batch and writes its results; returns the exit status.
int Batch(const BatchArguments& arguments);

// Reads the whole list before anything is run. Throws Error, naming the line, for options that
// `alidade run` refuses (usage) and for files that cannot be read (input).
std::vector<BatchWork> WorksOf(const BatchArguments& arguments);

// Done by this program with the same files.
bool IsDone(const BatchFolder& folder, const BatchWork& work);

std::string OwnProgram();  // path of this executable

// Writes the scripts of a Slurm job array for the recordings that are not done, and of a job that
// writes the table afterwards, and submits both. Returns the exit status. Throws Error (input) if
// Slurm is missing or refuses them.
int SubmitToSlurm(const BatchArguments& arguments, const BatchFolder& folder,
                  const std::vector<BatchWork>& works);

}  // namespace alidade
