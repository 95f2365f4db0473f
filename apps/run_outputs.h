// The folder `alidade run` leaves behind (docs/formats.md).
#pragma once

#include <string>

#include "run_record.h"

namespace alidade {

// A folder for results, made when it is not there. One that is there is taken when it is empty or
// holds an earlier run, whose files are removed (ours only). Throws Error (input) for any other,
// and when nothing can be written into it: better now than after the work.
class OutputFolder {
 public:
  // `kept`: a file of ours that stays until it is written anew (the map that was loaded).
  explicit OutputFolder(const std::string& path, const std::string& kept = {});
  const std::string& path() const { return path_; }

  // Writes a file whole or not at all.
  void Write(const std::string& name, const std::string& bytes);
  // Undoes the above, for a run that cannot leave results: our files, and the folder if we made it.
  void Remove();

 private:
  std::string path_, kept_;
  bool made_ = false;
};

struct RunSummary {
  int frames = 0, tracked = 0;
  int keyframes = 0, landmarks = 0, maps = 0;
  double path_length = 0;  // metres (mono: map units)
};

// Writes everything. Throws Error (input) when a file cannot be written; what stays then is whole,
// and is nothing at all unless stats.json is among it.
RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record,
                        bool with_map = true);

}  // namespace alidade
