// Reads which run a result folder belongs to, and decides when another run may replace it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace alidade {

// The source and command of results. Results of different owners are never mixed.
struct ResultOwner {
  std::string command = "run";  // or "localize"
  std::string source;           // as typed
  // Identity of the source independent of how it is typed: absolute path with links resolved;
  // rendered scenes as typed. Empty: unique (live cameras).
  std::string place;

  std::string InWords() const { return "`alidade " + command + " " + source + "`"; }
};
ResultOwner OwnerOf(const std::string& source, bool localize);

struct EarlierResult {
  ResultOwner owner;
  double frames = 0;  // frames of the source, late ones included
  double tracked = 0;
  bool complete = true;  // the run ended successfully
  // Files of the run as listed in stats.json; older versions have no list.
  std::optional<std::vector<std::string>> files;
};

// From a stats.json; nullopt if it does not exist or was not written by alidade.
std::optional<EarlierResult> ReadEarlierResult(const std::string& stats_path);

bool IsOf(const EarlierResult& result, const ResultOwner& owner);

// True if the results belong to another owner and would be lost.
bool IsTakenFrom(const std::optional<EarlierResult>& result, const ResultOwner& owner);

// Whether `now` may replace an earlier result of the same owner: not if it failed or was
// interrupted and the other one succeeded, and not if the source had fewer frames.
bool MayReplace(const EarlierResult& earlier, const EarlierResult& now);

// `folder`, or `folder`-2, -3, … if that is taken, with a warning.
std::string FreeFolder(const std::string& folder, const ResultOwner& owner);

}  // namespace alidade
