// Tells each pose of a run as it comes, to the standard output or by UDP
// (docs/reference/poses.md).
#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include "alidade/run/play/watcher.h"

namespace alidade {

class PoseTeller : public RunWatcher {
 public:
  // `where`: "-", "udp:HOST:PORT", or either of them after "json:". With "-", what is printed to
  // stdout from now on goes to stderr. Throws Error: usage if `where` is none of these, input if
  // the host is not found.
  explicit PoseTeller(const std::string& where);
  ~PoseTeller() override;
  PoseTeller(const PoseTeller&) = delete;
  PoseTeller& operator=(const PoseTeller&) = delete;

  void Begin(const WatchedRun& run, const std::string& folder) override;
  void Frame(const SourceFrame& frame, const TrackResult& result) override;

 private:
  void Tell(const std::string& line);  // a line, a datagram

  bool json_ = false;
  std::FILE* out_ = nullptr;  // the standard output; null: by UDP
  int socket_ = -1;
  bool failed_ = false;
  std::optional<WatchedRun> watched_;
  MapId map_;  // of the last pose
};

}  // namespace alidade
