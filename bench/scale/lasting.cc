#include "bench/scale/lasting.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "alidade/base/timing.h"
#include "alidade/io/read_ahead.h"
#include "alidade/io/wrappers.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/run/sources/frame_input.h"
#include "alidade/slam.h"
#include "bench/measure/recording.h"

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
  settings.localize = true;
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
  ReadAhead reader(Repeat(Open(source, sensor), kRepeats));
  SlamSettings settings;
  settings.sensor = reader.Info().sensor;
  settings.threaded = true;
  Slam slam(reader.Info().camera, settings);

  Section section{"lasting " + source};
  Table table{"forth and back, threaded",
              {{"tracked", "%"},
               {"resident_memory", "MB"},
               {"track", "ms"},
               {"keyframes"},
               {"keyframe_ids"},
               {"landmarks"},
               {"landmark_ids"},
               {"culled_remembered"},
               {"forwards_remembered"}}};
  table.note =
      "track: median of the last 1000 calls. keyframes, landmarks: in the map; ids: ever issued; "
      "remembered: culled keyframes and fused landmarks.";
  const auto line_of = [&](const std::string& name, int count, std::vector<double> values) {
    Case of{ShortName(source) + ", " + name, NameOf(settings.sensor), "desktop", source, name};
    of.frames = count;
    return Line{std::move(of), std::move(values)};
  };
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
      table.lines.push_back(line_of(
          std::to_string(seen) + " frames", seen,
          {100.0 * tracked / seen, ResidentMegabytes(), Milliseconds(window),
           static_cast<double>(map.keyframe_count()), static_cast<double>(map.next_keyframe()),
           static_cast<double>(map.landmark_count()), static_cast<double>(map.next_landmark()),
           static_cast<double>(map.state().culled.size()),
           static_cast<double>(map.state().forwards.size())}));
      std::fprintf(stderr, "%d of %d frames, %.0f MB, %.2f ms\n", seen, frames,
                   table.lines.back().values[1], table.lines.back().values[2]);
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
            {{"map", "MB"}, {"saving", "ms"}, {"loading", "ms"}, {"localized", "%"}}};
  end.lines.push_back(line_of("at the end", seen,
                              {static_cast<double>(bytes.size()) * 1e-6, saving, loading,
                               Localised(source, sensor, bytes)}));
  end.note = "localized: of the recording's first 100 frames.";
  section.tables.push_back(std::move(end));
  return section;
}

}  // namespace alidade::bench
