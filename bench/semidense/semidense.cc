#include "bench/semidense/semidense.h"

#include <algorithm>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/run/sources/synth_source.h"
#include "alidade/semidense/semidense_mapper.h"
#include "bench/measure/reference.h"
#include "bench/semidense/dense_map.h"

namespace alidade::bench {
namespace {

struct Variant {
  std::string name;
  const DenseMap* dense;
  SemiDenseSettings settings;
};

// One with everything, one without each step, and different numbers of keyframes searched.
std::vector<Variant> Ablations(const DenseMap& dense, const SemiDenseSettings& all) {
  std::vector<Variant> variants{{"all steps, N = " + std::to_string(all.keyframes), &dense, all}};
  const auto add = [&](const std::string& name, auto change) {
    variants.push_back({name, &dense, all});
    change(variants.back().settings);
  };
  add("without fusion (2)", [](SemiDenseSettings& s) { s.fuse = false; });
  add("without smoothing (3)", [](SemiDenseSettings& s) { s.smooth = false; });
  add("without the check (4)", [](SemiDenseSettings& s) { s.cross_check = false; });
  for (const int n : {3, 5, 7, 10}) {
    if (n != all.keyframes)
      add("N = " + std::to_string(n), [n](SemiDenseSettings& s) { s.keyframes = n; });
  }
  return variants;
}

struct Measured {
  DepthScores scores;
  double milliseconds = 0;  // of CPU per keyframe
  double u = 0;             // the reference's, beside it
  double megabytes = 0;     // held per keyframe at the end
  SemiDenseReport report;
};

// Milliseconds of CPU time; with one thread at work nothing else of the machine is in it.
template <typename Work>
double CpuMilliseconds(Work&& work) {
  const double start = ProcessCpuSeconds();
  work();
  return (ProcessCpuSeconds() - start) * 1e3;
}

Measured Measure(const Variant& variant, std::vector<double>& u_milliseconds) {
  constexpr size_t kTurns = 10;  // of the reference, before and after
  const DenseMap& dense = *variant.dense;
  Reference reference;
  std::vector<double> u;
  const auto take_u = [&] {
    for (size_t i = 0; i < kTurns; ++i) {
      const cv::Mat& image = dense.keyframes[i % dense.keyframes.size()].image;
      u.push_back(CpuMilliseconds([&] { reference.Run(image); }));
    }
  };
  MapStore store;
  store.Restore(dense.map);
  Measured measured;
  take_u();
  measured.milliseconds = CpuMilliseconds([&] {
                            SemiDenseMapper mapper(store, dense.camera, variant.settings);
                            for (const DenseKeyFrame& keyframe : dense.keyframes)
                              mapper.Keep(keyframe.id, keyframe.picture);
                            mapper.Finish();
                            measured.report = mapper.report();
                          }) /
                          static_cast<double>(dense.keyframes.size());
  take_u();
  measured.u = Summarise(u).median;
  measured.megabytes = 1e-6 * static_cast<double>(measured.report.bytes) /
                       static_cast<double>(dense.keyframes.size());
  measured.scores = ScoreDense(dense, store.Snapshot());
  u_milliseconds.insert(u_milliseconds.end(), u.begin(), u.end());
  return measured;
}

std::vector<double> Errors(const DepthScore& s) {
  return {100 * s.median_rel, 100 * s.p90_rel, 100 * s.within_2, 100 * s.within_5,
          100 * s.within_10};
}

// What the scored pixels are; then what was found, of all there is; then the work.
std::vector<double> Figures(const DepthScore& s, const Measured& m) {
  const auto mean = [](int64_t sum, int64_t count) {
    return count > 0 ? static_cast<double>(sum) / static_cast<double>(count)
                     : std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<double> figures = Errors(s);
  for (const double share : {s.density, s.density_gradient, s.edge_coverage})
    figures.push_back(100 * share);
  figures.push_back(m.milliseconds);
  figures.push_back(m.milliseconds / m.u);
  figures.push_back(mean(m.report.pixels, m.report.keyframes));
  figures.push_back(mean(m.report.search.searches, m.report.pixels));
  figures.push_back(mean(m.report.search.samples, m.report.search.searches));
  figures.push_back(m.megabytes);
  return figures;
}

std::string About(const std::string& name, const DenseMap& dense) {
  return name + ": " + std::to_string(dense.keyframes.size()) + " keyframes, " +
         std::to_string(dense.tracked) + " of " + std::to_string(dense.frames) +
         " frames tracked. ";
}

}  // namespace

Section BenchSemiDense(const std::string& source, int frames) {
  if (frames == 0) frames = IsSynthSource(source) ? 200 : 600;
  SlamSettings mono, phone;
  mono.sensor = phone.sensor = Sensor::kMono;
  phone.ApplyProfile("phone");
  Section section;
  section.name = "semidense " + source;

  SetThreadCount(1);
  const auto usable = [](const DenseMap& dense) { return dense.keyframes.size() >= 3; };
  const DenseMap desktop_map = MakeDenseMap(source, frames, mono);
  if (!usable(desktop_map)) {
    ThrowInput("semidense: from " + std::to_string(desktop_map.frames) + " frames of " + source +
               " no map with known depth could be made");
  }
  std::vector<Variant> variants = Ablations(desktop_map, mono.semidense);
  std::string note = About("One camera", desktop_map);
  const DenseMap phone_map = MakeDenseMap(source, frames, phone);
  if (usable(phone_map)) variants.push_back({"phone profile", &phone_map, phone.semidense});
  note += About("Phone", phone_map);
  // The depth of a sensor needs a map in metres.
  DenseMap metric_map;
  SlamSettings metric;
  metric.sensor = desktop_map.source;
  const bool pair = metric.sensor == Sensor::kStereo;
  if (metric.sensor != Sensor::kMono) {
    metric_map = MakeDenseMap(source, frames, metric);
    note += About(pair ? "Stereo" : "RGB-D", metric_map);
  }
  if (usable(metric_map)) {
    variants.push_back({pair ? "stereo map" : "RGB-D map", &metric_map, metric.semidense});
    metric.semidense.from_sensor = true;
    if (!pair) variants.push_back({"RGB-D map, sensor's", &metric_map, metric.semidense});
  }

  const bool rendered = desktop_map.rendered;
  const std::string truth = rendered ? "rendered depth" : "the sensor's depth";
  Table table{"error against " + truth + (rendered ? "" : " at depth-continuous pixels") +
                  ", density, CPU time per keyframe",
              {{"error_median", "%"},
               {"error_p90", "%"},
               {"within_2", "%"},
               {"within_5", "%"},
               {"within_10", "%"},
               {"density", "%"},
               {"density_of_gradients", "%"},
               {"edge_coverage", "%"},
               {"cpu", "ms"},
               {"cpu", "U"},
               {"pixels"},
               {"searches"},
               {"search_length"},
               {"memory", "MB"}}};
  table.note = note;
  Table everywhere{"error against " + truth + " at all pixels",
                   {{"error_median_everywhere", "%"},
                    {"error_p90_everywhere", "%"},
                    {"within_2_everywhere", "%"},
                    {"within_5_everywhere", "%"},
                    {"within_10_everywhere", "%"}}};
  for (const Variant& variant : variants) {
    const Measured measured = Measure(variant, section.u_milliseconds);
    const DepthScores& scores = measured.scores;
    Case of{ShortName(source) + ", " + variant.name};
    of.sensor = NameOf(variant.dense->sensor);
    of.profile = variant.dense == &phone_map ? "phone" : "desktop";
    of.source = source;
    of.variant = variant.name;
    of.frames = variant.dense->frames;
    table.lines.push_back({of, Figures(rendered ? scores.all : scores.continuous, measured)});
    everywhere.lines.push_back({std::move(of), Errors(scores.all)});
  }
  section.tables.push_back(std::move(table));
  if (!rendered) section.tables.push_back(std::move(everywhere));
  SetThreadCount(0);
  section.tables.push_back(BenchSemiDenseLive(source, frames, section.u_milliseconds));
  return section;
}

}  // namespace alidade::bench
