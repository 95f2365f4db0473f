#include "alidade/run/batch/batch_state.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/calibration_beside.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/file.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/version.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

class Fnv1a {  // 64 bit
 public:
  void Add(std::string_view bytes) {
    for (const char c : bytes) Take(static_cast<unsigned char>(c));
    Take(0);
  }
  void Add(int64_t number) { Add(std::to_string(number)); }
  std::string Hex() const {
    char text[20];
    std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash_));
    return text;
  }

 private:
  void Take(unsigned char byte) { hash_ = (hash_ ^ byte) * 0x100000001b3ull; }
  uint64_t hash_ = 0xcbf29ce484222325ull;
};

void AddFile(Fnv1a& hash, const fs::path& path, const std::string& name) {
  struct stat info {};
  hash.Add(name);
  if (stat(path.c_str(), &info) != 0) return hash.Add("gone");
  hash.Add(static_cast<int64_t>(info.st_size));
  hash.Add(static_cast<int64_t>(info.st_mtim.tv_sec));
  hash.Add(static_cast<int64_t>(info.st_mtim.tv_nsec));
}

// A calibration in the folder of a video or a ROS recording is used without an option; for a folder
// of images it is part of the source.
void AddCalibrationBeside(Fnv1a& hash, const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return;
  const auto files = CalibrationFilesIn(path.parent_path().string());
  for (const std::string& file : files) hash.Add(IsFile(file) ? ReadFile(file) : "none");
  if (files.empty()) hash.Add("none");
}

// A file, or all files of a folder.
void AddSource(Fnv1a& hash, const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return AddFile(hash, path, "");
  std::vector<std::string> names;
  const auto options = fs::directory_options::skip_permission_denied |
                       fs::directory_options::follow_directory_symlink;
  for (fs::recursive_directory_iterator it(path, options, error), end; it != end && !error;
       it.increment(error)) {
    if (it->is_regular_file(error)) names.push_back(it->path().lexically_relative(path).string());
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) AddFile(hash, path / name, name);
}

void AddContent(Fnv1a& hash, const std::optional<std::string>& path) {
  if (path) hash.Add(IsFile(*path) ? ReadFile(*path) : "gone");
}

// Removes options that do not change results: "--threads 4", "--threads=4", "--quiet",
// "--overwrite".
std::vector<std::string> TellingWords(const std::vector<std::string>& words) {
  std::vector<std::string> telling;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--threads") {
      ++i;
    } else if (words[i].rfind("--threads=", 0) != 0 && words[i] != "--quiet" &&
               words[i] != "--overwrite") {
      telling.push_back(words[i]);
    }
  }
  return telling;
}

std::string HostName() {
  char name[256] = "?";
  gethostname(name, sizeof(name) - 1);
  return name;
}

}  // namespace

std::string FingerprintOf(const BatchItem& item, const RunOptions& options,
                          const std::string& program) {
  Fnv1a hash;
  hash.Add(ALIDADE_VERSION);
  hash.Add(program);
  for (const std::string& word : TellingWords(item.words)) hash.Add(word);
  if (const std::string path = PathOfSource(options.source); !path.empty()) {
    AddSource(hash, path);
    AddCalibrationBeside(hash, path);
  }
  AddContent(hash, options.config);
  AddContent(hash, options.camera_file ? std::optional(CameraFilePath(*options.camera_file))
                                       : std::nullopt);
  for (const auto& file : {options.detector, options.load}) {
    if (file) AddSource(hash, *file);
  }
  return hash.Hex();
}

BatchFolder::BatchFolder(const std::string& path) : path_(path) {
  if (path.empty()) ThrowUsage("--out must not be empty");
  std::error_code error;
  if (IsFolder(path) && !fs::is_empty(path, error) && !IsFolder(path + "/done"))
    ThrowInput(path + " contains other files than those of a batch: choose another --out");
  for (const char* part : {"/log", "/done"}) {
    fs::create_directories(path + part, error);
    if (error) ThrowInput(path + part + ": cannot be created: " + error.message());
  }
}

std::optional<BatchDone> BatchFolder::DoneOf(const BatchItem& item) const {
  const std::string file = path_ + "/done/" + item.name + ".json";
  if (!IsFile(file)) return std::nullopt;
  const auto json = nlohmann::json::parse(ReadFile(file), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return std::nullopt;
  const auto number = [&](const char* name) {
    return json.contains(name) && json[name].is_number() ? json[name].get<double>() : 0.0;
  };
  const auto word = [&](const char* name) {
    return json.contains(name) && json[name].is_string() ? json[name].get<std::string>() : "";
  };
  BatchDone done;
  done.fingerprint = word("fingerprint");
  done.status = static_cast<int>(std::clamp(number("status"), -1e3, 1e3));
  done.wall_s = number("wall_s");
  done.cpu_s = number("cpu_s");
  done.peak_mb = number("peak_mb");
  done.message = word("message");
  if (done.fingerprint.empty() || !json.contains("status")) return std::nullopt;
  return done;
}

void BatchFolder::SetDone(const BatchItem& item, const BatchDone& done) {
  const nlohmann::ordered_json json = {
      {"name", item.name},       {"words", item.words},    {"fingerprint", done.fingerprint},
      {"status", done.status},   {"wall_s", done.wall_s},  {"cpu_s", done.cpu_s},
      {"peak_mb", done.peak_mb}, {"message", done.message}};
  AtomicWriteFile(
      path_ + "/done/" + item.name + ".json",
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void BatchFolder::Forget(const BatchItem& item) {
  std::error_code ignored;
  fs::remove(path_ + "/done/" + item.name + ".json", ignored);
}

void BatchFolder::Note(const std::string& what, const BatchItem& item) {
  char when[32];
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(when, sizeof(when), "%Y-%m-%dT%H:%M:%SZ", &utc);
  const std::string line =
      std::string(when) + " " + HostName() + " " + what + " " + item.name + "\n";
  const int fd =
      open((path_ + "/batch.log").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0) return;  // logging is optional
  const auto written = write(fd, line.data(), line.size());
  (void)written;
  close(fd);
}

}  // namespace alidade
