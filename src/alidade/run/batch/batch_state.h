// What a batch has finished, and with which program and inputs; stored in its folder, so that an
// interrupted batch can continue.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "alidade/run/batch/batch_list.h"
#include "alidade/run/setup/options.h"

namespace alidade {

// Hash of everything a result depends on, as 16 hexadecimal digits: the words of its line, the
// files of its source (name, size and modification time) and of its options (content of settings
// and calibration), the version of the program and the program file. The number of threads does not
// count.
std::string FingerprintOf(const BatchItem& item, const RunOptions& options,
                          const std::string& program);

struct BatchDone {
  std::string fingerprint;
  int status = 0;                             // exit status; -N: ended by signal N
  double wall_s = 0, cpu_s = 0, peak_mb = 0;  // of the process
  std::string message;                        // last output line of a failed run
};

// The folder of a batch: NAME/ with results, log/NAME.txt with the output, done/NAME.json with a
// BatchDone.
class BatchFolder {
 public:
  // Creates the folder. Throws Error (input) if it cannot be written, or contains other files.
  explicit BatchFolder(const std::string& path);
  const std::string& path() const { return path_; }
  std::string ResultOf(const BatchItem& item) const { return path_ + "/" + item.name; }
  std::string LogOf(const BatchItem& item) const { return path_ + "/log/" + item.name + ".txt"; }
  // nullopt if the item has never been run to its end.
  std::optional<BatchDone> DoneOf(const BatchItem& item) const;
  void SetDone(const BatchItem& item, const BatchDone& done);
  void Forget(const BatchItem& item);  // called when a run starts again
  // Appends a line to batch.log: time, machine, what, name. Safe for several processes.
  void Note(const std::string& what, const BatchItem& item);

 private:
  std::string path_;
};

}  // namespace alidade
