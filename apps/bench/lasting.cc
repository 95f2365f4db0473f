#include "bench/lasting.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "alidade/base/timing.h"
#include "alidade/io/read_ahead.h"
#include "alidade/io/wrappers.h"
#include "alidade/run/any_source.h"
#include "alidade/run/loop.h"
#include "alidade/run/options.h"
#include "alidade/slam.h"

namespace alidade::bench {
namespace {

constexpr int kWindow = 1000;     // frames a median is taken of
constexpr int kLocalised = 100;   // frames looked for in the saved map
constexpr int kRepeats = 100000;  // of the recording: more than anyone asks frames for

double ResidentMegabytes() {
  long pages = 0, resident = 0;
  if (FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

std::unique_ptr<FrameSource> Open(const std::string& source, const std::string& sensor) {
  SourceOptions options;
  if (!sensor.empty()) options.sensor = SensorNamed("--sensor", sensor);
  return OpenAnySource(source, options);
}

double Milliseconds(const std::vector<double>& window) { return Summarise(window).median; }

// How much of the recording is found in the map that was saved, percent.
double Localised(const std::string& source, const std::string& sensor, const std::string& bytes) {
  const auto frames = Open(source, sensor);
  SlamSettings settings;
  settings.sensor = frames->Info().sensor;
  settings.localise = true;
  Slam slam(frames->Info().camera, settings);
  slam.Load(DecodeMap(bytes));
  int seen = 0, tracked = 0;
  while (const auto frame = frames->Next()) {
    if (!frame->problem.empty()) continue;
    tracked += slam.Track(InputOf(*frame)).state == TrackState::kTracking;
    if (++seen == kLocalised) break;
  }
  return seen > 0 ? 100.0 * tracked / seen : 0;
}

}  // namespace

Section BenchLasting(const std::string& source, int frames, const std::string& sensor) {
  if (frames == 0) frames = 20000;
  ReadAhead reader(Repeat(Open(source, sensor), kRepeats));
  SlamSettings settings;
  settings.sensor = reader.Info().sensor;
  settings.threaded = true;
  Slam slam(reader.Info().camera, settings);

  Section section;
  section.name = "lasting";
  Table table{source + ", forth and back, threaded",
              {"frames", "tracked %", "RSS MB", "Track ms", "keyframes", "issued", "landmarks",
               "issued", "culled", "forwards"}};
  table.note =
      "RSS: resident memory. Track: median of the last 1000 calls. Landmarks and keyframes that "
      "live, and ids issued; what is remembered of culled and fused ones.";
  std::vector<double> window;
  int seen = 0, tracked = 0;
  while (seen < frames) {
    const auto frame = reader.Next();
    if (!frame) break;
    if (!frame->problem.empty()) continue;
    const Stopwatch watch;
    tracked += slam.Track(InputOf(*frame)).state == TrackState::kTracking;
    window.push_back(watch.Milliseconds());
    if (++seen % kWindow != 0) continue;
    const int every = std::max(kWindow, frames / 10 / kWindow * kWindow);
    if (seen % every == 0 || seen == 2 * kWindow) {
      const MapSnapshot map = slam.Snapshot();
      table.rows.push_back(
          {static_cast<double>(seen), 100.0 * tracked / seen, ResidentMegabytes(),
           Milliseconds(window), static_cast<double>(map.keyframe_count()),
           static_cast<double>(map.next_keyframe()), static_cast<double>(map.landmark_count()),
           static_cast<double>(map.next_landmark()), static_cast<double>(map.state().culled.size()),
           static_cast<double>(map.state().forwards.size())});
      std::fprintf(stderr, "%d of %d frames, %.0f MB, %.2f ms\n", seen, frames,
                   table.rows.back()[2], table.rows.back()[3]);
    }
    window.clear();
  }
  slam.Finish();
  section.tables.push_back(std::move(table));

  Stopwatch watch;
  const std::string bytes = slam.SaveMap();
  const double saving = watch.Milliseconds();
  watch = Stopwatch();
  DecodeMap(bytes);
  const double loading = watch.Milliseconds();
  Table end{"the map at the end",
            {"map MB", "saving ms", "loading ms", "localised %"},
            {{static_cast<double>(bytes.size()) * 1e-6, saving, loading,
              Localised(source, sensor, bytes)}}};
  end.note = "localised: of the recording's first 100 frames.";
  section.tables.push_back(std::move(end));
  return section;
}

}  // namespace alidade::bench
