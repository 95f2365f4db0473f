// What a folder of results says of itself, and when a run may take its place.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace alidade {

// Whose results are: they are never mixed up with those of another.
struct ResultOwner {
  std::string command = "run";  // or "localize"
  std::string source;           // as typed
  // What it is, wherever it is typed: absolute, links resolved; rendered scenes as typed. Empty: no
  // other run is of the same (live cameras).
  std::string place;

  std::string InWords() const { return "`alidade " + command + " " + source + "`"; }
};
ResultOwner OwnerOf(const std::string& source, bool localize);

struct EarlierResult {
  ResultOwner owner;
  double frames = 0;  // that the source gave, late ones included
  double tracked = 0;
  bool complete = true;  // the run ended well
  // Names of the run's own files, as it noted them; older versions did not.
  std::optional<std::vector<std::string>> files;
};

// Of a stats.json; nothing when it is not there, or none of ours.
std::optional<EarlierResult> ReadEarlierResult(const std::string& stats_path);

bool IsOf(const EarlierResult& result, const ResultOwner& owner);

// Something would be lost, and another owner's at that.
bool IsTakenFrom(const std::optional<EarlierResult>& result, const ResultOwner& owner);

// Whether `now` may take the place of an earlier result of the same owner: never when it is a
// failed or interrupted run and the other was not, nor when the source gave it fewer frames.
bool MayReplace(const EarlierResult& earlier, const EarlierResult& now);

// `folder`, or where that is taken `folder`-2, -3, …; says so.
std::string FreeFolder(const std::string& folder, const ResultOwner& owner);

}  // namespace alidade
