// What is done of a batch, and by what: kept in its folder, so that it goes on where it stopped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "alidade/run/batch/batch_list.h"
#include "alidade/run/setup/options.h"

namespace alidade {

// What a result depends on: the words of its line, the files of its source (name, size and time of
// change) and of its options (content of settings and calibration), the program's version, and the
// program itself. Not the number of threads. 16 hexadecimal digits.
std::string FingerprintOf(const BatchItem& item, const RunOptions& options,
                          const std::string& program);

struct BatchDone {
  std::string fingerprint;
  int status = 0;                             // exit status; -N: ended by signal N
  double wall_s = 0, cpu_s = 0, peak_mb = 0;  // of the process
  std::string message;                        // its last words, where it failed
};

// One folder for all: NAME/ the results, log/NAME.txt what was said, done/NAME.json the above.
class BatchFolder {
 public:
  // Makes it. Throws Error (input) when it cannot be written, or is something else's.
  explicit BatchFolder(const std::string& path);
  const std::string& path() const { return path_; }
  std::string ResultOf(const BatchItem& item) const { return path_ + "/" + item.name; }
  std::string LogOf(const BatchItem& item) const { return path_ + "/log/" + item.name + ".txt"; }
  // Nothing when it was never run to an end.
  std::optional<BatchDone> DoneOf(const BatchItem& item) const;
  void SetDone(const BatchItem& item, const BatchDone& done);
  void Forget(const BatchItem& item);  // it begins anew
  // A line of batch.log: time, machine, what, name. Lines of several processes do not mix.
  void Note(const std::string& what, const BatchItem& item);

 private:
  std::string path_;
};

}  // namespace alidade
