// The folder of a run's results. A run's files are gathered beside those of an earlier one, and
// take their place when the run has ended: whoever fails or is killed leaves the earlier ones.
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
  std::vector<std::string> inputs = {};  // files the run was given: never removed
  bool overwrite = false;                // whatever is there, it is replaced
};

// Where a run's files are in the end.
struct PlacedResult {
  std::string folder;   // empty: the run left nothing
  std::string problem;  // why it is not the folder that was asked for; empty: it is
};

// A folder for results, made when it is not there, and locked against other runs. One that is there
// is taken when it is empty or holds an earlier run. Throws Error (input) for any other, for one
// that holds results of another owner, for one another run is at work in, and when nothing can be
// written into it: better now than after the work.
class OutputFolder {
 public:
  explicit OutputFolder(OutputClaim claim);
  const std::string& path() const { return claim_.path; }

  // Where files are gathered until Place().
  const std::string& draft() const { return draft_->path(); }
  // Writes a file whole or not at all, making the folder it is in. Throws Error (input).
  void Write(const std::string& name, const std::string& bytes, Sync sync = Sync::kYes);
  // Takes back what was written; the folder it was in goes when it is empty.
  void Discard(const std::string& name);

  // Puts the files in place of the earlier run's, or where that may not be (MayReplace) into the
  // folder last-attempt, and notes in stats.json which they are. Without a stats.json nothing
  // stays. `complete`: the run ended well. Throws Error (input).
  PlacedResult Place(bool complete);

 private:
  // Makes the folder; it is removed at the end where nothing is in it.
  struct MadeFolder {
    explicit MadeFolder(const OutputClaim& claim);
    ~MadeFolder();
    std::string path;  // empty: it was there
  };

  const OutputClaim claim_;
  const MadeFolder made_;
  const FolderLock lock_;
  std::optional<DraftFolder> draft_;
};

}  // namespace alidade
