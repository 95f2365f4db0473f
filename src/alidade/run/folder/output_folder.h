// The result folder of a run. Files are gathered in a temporary folder and replace those of the
// earlier run at the end, so a run that fails or is killed does not damage earlier results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/files/file.h"
#include "alidade/run/folder/draft_folder.h"
#include "alidade/run/folder/earlier_result.h"
#include "alidade/run/folder/folder_lock.h"
#include "alidade/run/folder/own_files.h"

namespace alidade {

struct OutputClaim {
  std::string path;
  ResultOwner owner = {};
  std::vector<std::string> inputs = {};  // input files of the run: never removed
  bool overwrite = false;                // replace any existing results
};

// Where the files of a run are after Place().
struct PlacedResult {
  std::string folder;   // empty: the run wrote nothing
  std::string problem;  // why it is not the requested folder; empty: it is
};

// Creates and locks a result folder. An existing one must be empty or contain an earlier run.
// Throws Error (input) for any other folder, for results of another owner, if another run is
// writing to it, and if it is not writable: better before the run than after it.
class OutputFolder {
 public:
  explicit OutputFolder(OutputClaim claim);
  const std::string& path() const { return claim_.path; }

  // Folder where files are gathered until Place().
  const std::string& draft() const { return draft_->path(); }
  // Writes a file completely or not at all; creates its folder. Throws Error (input).
  void Write(const std::string& name, const std::string& bytes, Sync sync = Sync::kYes);
  // Removes a written file, and its folder if that is empty.
  void Discard(const std::string& name);

  // Replaces the files of the earlier run, or moves them to the folder last-attempt if MayReplace()
  // is false, and lists them in stats.json. Without a stats.json nothing remains. `complete`: the
  // run ended successfully. Throws Error (input).
  PlacedResult Place(bool complete);

 private:
  // Creates the folder; the destructor removes it if it is empty.
  struct MadeFolder {
    explicit MadeFolder(const OutputClaim& claim);
    ~MadeFolder();
    std::string path;  // empty: the folder existed before
  };

  const OutputClaim claim_;
  const MadeFolder made_;
  const FolderLock lock_;
  std::optional<DraftFolder> draft_;
};

}  // namespace alidade
