#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/shell_quoted.h"
#include "alidade/io/files/file.h"
#include "bench/phone/phone.h"

namespace alidade::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Gone when done with: the frames of a recording take a hundred megabytes.
class JobFolder {
 public:
  JobFolder() {
    std::string pattern = (fs::temp_directory_path() / "alidade-bench-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) ThrowInput("cannot create the folder " + pattern);
    path_ = pattern;
  }
  ~JobFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  JobFolder(const JobFolder&) = delete;
  JobFolder& operator=(const JobFolder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

// What web/tools/build_core.mjs leaves beside the modules; empty: it is not there.
std::string FindDriver() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path driver = program / "../../build-wasm/bench/bench.mjs";
  const bool module = fs::exists(program / "../../build-wasm/single/bin/alidade.wasm", error);
  return module && fs::exists(driver, error) ? fs::weakly_canonical(driver, error).string() : "";
}

// What differs from the phone profile, which the module begins with, as after --set.
json Differences(const SlamSettings& settings) {
  SlamSettings phone;
  phone.ApplyProfile("phone");
  const auto usual = phone.All(), all = settings.All();
  json made = json::object();
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i] != usual[i]) made[all[i].first] = all[i].second;
  return made;
}

void WriteJob(const Recording& recording, const SlamSettings& settings, const JobFolder& folder) {
  std::ofstream pixels(folder / "frames.gray", std::ios::binary);
  std::vector<double> times;
  for (const SourceFrame& frame : recording.frames) {
    const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
    pixels.write(reinterpret_cast<const char*>(image.data),
                 static_cast<std::streamsize>(image.total() * image.elemSize()));
    times.push_back(frame.time);
  }
  if (!pixels.flush()) ThrowInput("cannot write to " + folder / "frames.gray");
  const Camera& camera = recording.info.camera;
  const json job = {{"width", camera.width},
                    {"height", camera.height},
                    {"times", times},
                    {"camera",
                     {{"fx", camera.fx},
                      {"fy", camera.fy},
                      {"cx", camera.cx},
                      {"cy", camera.cy},
                      {"distortion", camera.distortion}}},
                    {"settings", Differences(settings)}};
  AtomicWriteFile(folder / "job.json", job.dump());
}

}  // namespace

std::optional<PhoneRun> RunWasm(const PhoneRecording& from, const SlamSettings& settings,
                                std::string* problem) {
  const std::string driver = FindDriver();
  if (driver.empty()) {
    *problem =
        "the core for browsers is not there (scripts/wasm/build single, npm run build:core in "
        "web/).";
    return std::nullopt;
  }
  if (std::system("command -v node >/dev/null 2>&1") != 0) {
    *problem = "Node.js was not found.";
    return std::nullopt;
  }
  const JobFolder folder;
  WriteJob(from.recording, settings, folder);
  const std::string command = "node " + ShellQuoted(driver) + " " + ShellQuoted(folder / "");
  if (std::system(command.c_str()) != 0) {
    *problem = "Node.js failed.";
    return std::nullopt;
  }
  const json result = json::parse(ReadFile(folder / "result.json"));
  PhoneRun run{result["frame"], result["extract"], result["track"], result["map"], {}, 0,
               result["cpu"]};
  run.keyframes = result["keyframes"];
  run.trajectory = ParseTumTrajectory(result["trajectory"].get<std::string>(), "the trajectory");
  return run;
}

}  // namespace alidade::bench
