#include "alidade/run/folder/output_folder.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/run/folder/place_files.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr char kLastAttempt[] = "last-attempt";

std::string Opening(const OutputClaim& claim) { return "--out " + claim.path + ": "; }

std::optional<EarlierResult> ResultIn(const fs::path& folder) {
  return ReadEarlierResult((folder / kStatsFile).string());
}

bool HoldsOtherThings(const fs::path& folder) {
  std::error_code error;
  const bool empty = HoldsNoResult(folder, error);
  if (error) ThrowInput("cannot read " + folder.string() + ": " + error.message());
  return !empty && !ResultIn(folder) && !ResultIn(folder / kRunDone);
}

void CheckOwner(const OutputClaim& claim) {
  const auto earlier = ResultIn(claim.path);
  if (claim.overwrite || !IsTakenFrom(earlier, claim.owner)) return;
  ThrowInput(Opening(claim) + "the folder contains the results of " + earlier->owner.InWords() +
             ", but the source is " + claim.owner.InWords() +
             ": choose another folder, or replace them with --overwrite");
}

// The message why the new results are elsewhere.
std::string Complaint(const OutputClaim& claim, const EarlierResult& earlier,
                      const EarlierResult& now, const std::string& place) {
  const auto frames = [](const EarlierResult& result) {
    return std::to_string(static_cast<long long>(result.frames)) + " frames";
  };
  return claim.path + " keeps the results of an earlier run (" + frames(earlier) +
         "; this run: " + frames(now) + "). The results of this run are in " + place +
         "; --overwrite replaces the earlier results";
}

// The data read by ReadEarlierResult().
void NoteFolder(const fs::path& draft, const ResultOwner& owner, bool complete) {
  using nlohmann::ordered_json;
  const std::string file = (draft / kStatsFile).string();
  ordered_json stats = ordered_json::parse(ReadFile(file));
  ordered_json names = ordered_json::array();
  std::vector<std::string> files = NamesIn(draft.string());
  std::sort(files.begin(), files.end());
  for (const std::string& name : files) {
    if (IsFile((draft / name).string())) names.push_back(name);
  }
  stats["folder"] = {{"command", owner.command},
                     {"source", owner.place},
                     {"complete", complete},
                     {"files", names}};
  AtomicWriteFile(file, stats.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace

OutputFolder::MadeFolder::MadeFolder(const OutputClaim& claim) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(claim.path, error))) {
    if (!fs::is_directory(claim.path, error))
      ThrowInput(Opening(claim) + "it is a file, not a folder");
    if (HoldsOtherThings(claim.path)) {
      ThrowInput(Opening(claim) +
                 "the folder exists and contains no earlier run (no stats.json of alidade); choose "
                 "another");
    }
    return;
  }
  fs::create_directories(claim.path, error);
  if (error) ThrowInput(Opening(claim) + "cannot be created: " + error.message());
  path = claim.path;
}

OutputFolder::MadeFolder::~MadeFolder() {
  std::error_code error;
  if (!path.empty()) fs::remove(path, error);  // succeeds only if it is empty
}

OutputFolder::OutputFolder(OutputClaim claim)
    : claim_(std::move(claim)),
      made_(claim_),
      lock_((fs::path(claim_.path) / kRunLock).string(), Opening(claim_)) {
  FinishPlacing(claim_.path, claim_.inputs);
  const fs::path done = fs::path(claim_.path) / kRunDone;
  if (IsThere(done.string()))
    ThrowInput(Opening(claim_) + "there is " + done.string() +
               ", which was not written by alidade: choose another folder");
  CheckOwner(claim_);
  std::error_code error;
  for (const fs::path& left : LeftoversIn(claim_.path)) fs::remove_all(left, error);
  draft_.emplace((fs::path(claim_.path) / kRunPlace).string());
  Write(kStatsFile, std::string(65536, '\0'));  // about the size of a short run's files
  Discard(kStatsFile);
}

void OutputFolder::Write(const std::string& name, const std::string& bytes, Sync sync) {
  const fs::path path = fs::path(draft()) / name;
  std::error_code error;
  if (fs::path(name).has_parent_path() && !fs::create_directories(path.parent_path(), error) &&
      error) {
    ThrowInput("cannot create " + path.parent_path().string() + ": " + error.message());
  }
  AtomicWriteFile(path.string(), bytes, sync);
}

void OutputFolder::Discard(const std::string& name) {
  const fs::path path = fs::path(draft()) / name;
  std::error_code ignored;
  fs::remove(path, ignored);
  if (fs::path(name).has_parent_path()) fs::remove(path.parent_path(), ignored);
}

PlacedResult OutputFolder::Place(bool complete) {
  const fs::path folder = claim_.path, attempt = folder / kLastAttempt;
  auto now = ResultIn(draft());
  if (!now) return {};
  now->complete = complete;
  PlacedResult placed{claim_.path, ""};
  const auto earlier = ResultIn(folder);
  if (earlier && !claim_.overwrite && !MayReplace(*earlier, *now)) {
    placed = {attempt.string(), Complaint(claim_, *earlier, *now, attempt.string())};
    std::error_code error;
    fs::create_directory(attempt, error);
    if (HoldsOtherThings(attempt)) return {"", placed.problem};
  }
  LeaveFilesOfOthers(draft(), placed.folder, claim_.inputs);
  try {
    NoteFolder(draft(), claim_.owner, complete);
  } catch (const Error&) {  // the disk is full; older versions had no list either
  }
  PlaceFiles(draft(), placed.folder, claim_.inputs);
  draft_.reset();
  return placed;
}

}  // namespace alidade
