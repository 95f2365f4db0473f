#include "bench/dynamic/tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "alidade/base/timing.h"

namespace alidade::bench {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr char kMedians[] = "Median over the seeds, each figure for itself.";

// One that has no value is worse than any.
double Median(std::vector<double> values) {
  for (double& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  const double median = values.empty() ? kNothing : Summarise(values).median;
  return std::isinf(median) ? kNothing : median;
}

template <typename Figure>
double MedianOf(const std::vector<DynamicRun>& runs, Figure&& figure) {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const DynamicRun& run : runs) values.push_back(figure(run));
  return Median(std::move(values));
}

double Improvement(double off, double mode) { return 100 * (off - mode) / off; }
double Rmse(const ErrorStatistics& s) { return s.n > 0 ? s.rmse : kNothing; }
double Std(const ErrorStatistics& s) { return s.n > 0 ? s.std : kNothing; }
double Percent(int part, int all) { return 100.0 * part / all; }

Line LineOf(const DynamicCase& of, const std::string& variant, std::vector<double> values) {
  Line line{of.of, std::move(values)};
  line.of.variant = variant;
  line.of.name += ", " + variant;
  return line;
}

// `errors`: which of them; `scale`: to the unit.
Table ErrorTable(const std::string& name, const std::vector<DynamicCase>& cases,
                 const std::string& metric, const std::string& unit,
                 ErrorStatistics DynamicErrors::*errors, double scale) {
  Table table{name,
              {{metric + "_rmse", unit},
               {metric + "_std", unit},
               {metric + "_rmse_improvement", "%"},
               {metric + "_std_improvement", "%"}}};
  for (const DynamicCase& of : cases) {
    double off = kNothing, off_std = kNothing;
    for (const DynamicVariant& variant : of.variants) {
      const double rmse = scale * MedianOf(variant.runs, [&](const DynamicRun& run) {
                            return Rmse(run.errors.*errors);
                          });
      const double std = scale * MedianOf(variant.runs, [&](const DynamicRun& run) {
                           return Std(run.errors.*errors);
                         });
      std::vector<double> row{rmse, std, kNothing, kNothing};
      if (variant.name == "off") {
        off = rmse;
        off_std = std;
      } else {
        row[2] = Improvement(off, rmse);
        row[3] = Improvement(off_std, std);
      }
      table.lines.push_back(LineOf(of, variant.name, std::move(row)));
    }
  }
  table.note = std::string("improvement: (off - mode) / off. ") + kMedians;
  return table;
}

std::vector<double> MaskRow(const DynamicCase& of, const DynamicVariant& variant) {
  const auto share = [&](Share MaskScores::*which) {
    return MedianOf(variant.runs,
                    [&](const DynamicRun& run) { return (run.masks.*which).percent(); });
  };
  return {100 * MedianOf(variant.runs, [](const DynamicRun& r) { return r.masks.mask.mean(); }),
          100 * of.detected_boxes.mean(),
          100 * of.people_boxes.mean(),
          share(&MaskScores::used_static),
          share(&MaskScores::kept_in_detected),
          share(&MaskScores::kept_in_people),
          share(&MaskScores::map_on_people),
          share(&MaskScores::depth_on_people)};
}

double StageMedian(const DynamicVariant& variant, std::vector<double> StageTimes::*stage) {
  return MedianOf(variant.runs, [&](const DynamicRun& run) {
    return (run.times.*stage).empty() ? kNothing : Summarise(run.times.*stage).median;
  });
}

}  // namespace

std::vector<Table> ErrorTables(const std::vector<DynamicCase>& cases) {
  return {
      ErrorTable("1. absolute trajectory error", cases, "ate", "cm", &DynamicErrors::ate, 100),
      ErrorTable("2. relative pose error, translation, every two poses", cases,
                 "rpe_every_translation", "cm", &DynamicErrors::every_trans, 100),
      ErrorTable("3. relative pose error, rotation, every two poses", cases, "rpe_every_rotation",
                 "deg", &DynamicErrors::every_rot, 1),
      ErrorTable("2b. relative pose error, translation over 1 s", cases, "rpe_1s_translation", "cm",
                 &DynamicErrors::second_trans, 100),
      ErrorTable("3b. relative pose error, rotation over 1 s", cases, "rpe_1s_rotation", "deg",
                 &DynamicErrors::second_rot, 1),
  };
}

Table CoverageTable(const std::vector<DynamicCase>& cases) {
  Table table{"4. coverage, and what the stages take in the inline schedule",
              {{"frames"},
               {"tracked"},
               {"tracked_share", "%"},
               {"start"},
               {"lost"},
               {"maps"},
               {"tracked_in_map_1"},
               {"extract", "ms"},
               {"track", "ms"},
               {"dynamics", "ms"}}};
  for (const DynamicCase& of : cases) {
    for (const DynamicVariant& variant : of.variants) {
      const auto median = [&](auto figure) { return MedianOf(variant.runs, figure); };
      table.lines.push_back(LineOf(
          of, variant.name,
          {median([](const DynamicRun& run) { return run.frames; }),
           median([](const DynamicRun& run) { return run.tracked; }),
           median([](const DynamicRun& run) { return Percent(run.tracked, run.frames); }),
           median([](const DynamicRun& run) { return run.start < 0 ? kNothing : run.start; }),
           median([](const DynamicRun& run) { return run.lost; }),
           median([](const DynamicRun& run) { return run.maps; }),
           median([](const DynamicRun& r) { return static_cast<double>(r.trajectory.size()); }),
           StageMedian(variant, &StageTimes::extract), StageMedian(variant, &StageTimes::track),
           StageMedian(variant, &StageTimes::dynamics)}));
    }
  }
  table.note = std::string("start: number of the first frame with a pose; lost: how often. ") +
               "Errors are those of map 1, the one with the most frames. " + kMedians;
  return table;
}

Table MaskTable(const std::vector<DynamicCase>& cases) {
  Table table{"masks of movers against the true ones",
              {{"mask_iou", "%"},
               {"detected_box_iou", "%"},
               {"true_box_iou", "%"},
               {"used_static", "%"},
               {"kept_in_detected_boxes", "%"},
               {"kept_in_true_boxes", "%"},
               {"map_on_people", "%"},
               {"depth_on_people", "%"}}};
  for (const DynamicCase& of : cases) {
    if (of.people_boxes.frames == 0) continue;
    for (const DynamicVariant& variant : of.variants)
      table.lines.push_back(LineOf(of, variant.name, MaskRow(of, variant)));
  }
  table.note =
      "iou: intersection over union, mean over the frames. used_static: share of the features in "
      "use that are not on people. kept: share of the features not on people inside the boxes that "
      "are in use. map, depth: share of landmark observations, of semi-dense pixels (with --set "
      "semidense.enabled=1) that lie on people.";
  return table;
}

Table PlainTable(const std::vector<DynamicCase>& cases) {
  const std::vector<double> limits = {1.05, 1.1, 1.15, 1.3, 1.5, 2.0};
  Table table{"against the same frames without people, on the frames both have a pose for",
              {{"plain_ate", "cm"}, {"here_ate", "cm"}, {"ratio"}, {"difference", "mm"}}};
  for (const double k : limits) {
    char name[40];
    std::snprintf(name, sizeof name, "limit_%g", k);
    table.columns.push_back({name, "cm"});
  }
  table.columns.push_back({"plain_ate_all", "cm"});
  table.columns.push_back({"plain_tracked"});
  for (const DynamicCase& of : cases) {
    if (of.plain.empty()) continue;
    for (const DynamicVariant& variant : of.variants) {
      const double plain = Median(variant.ate_plain), here = Median(variant.ate_here);
      std::vector<double> row{100 * plain, 100 * here, here / plain, 1000 * (here - plain)};
      for (const double k : limits) row.push_back(100 * std::max(k * plain, plain + 0.005));
      row.push_back(100 *
                    MedianOf(of.plain, [](const DynamicRun& run) { return Rmse(run.errors.ate); }));
      row.push_back(MedianOf(of.plain, [](const DynamicRun& run) { return run.tracked; }));
      table.lines.push_back(LineOf(of, variant.name, std::move(row)));
    }
  }
  table.note =
      "limit_k: max(k * plain, plain + 5 mm). plain_ate_all, plain_tracked: of the run without "
      "people alone, with dynamics off.";
  return table;
}

Table VariantTable(const std::string& name, const DynamicCase& of) {
  Table table{name,
              {{"ate_rmse", "cm"},
               {"ate_to_first"},
               {"ate_std", "cm"},
               {"rpe_1s_translation_rmse", "cm"},
               {"rpe_1s_rotation_rmse", "deg"},
               {"tracked"},
               {"start"},
               {"mask_iou", "%"},
               {"used_static", "%"},
               {"kept_in_true_boxes", "%"},
               {"dynamics", "ms"}}};
  for (const DynamicVariant& variant : of.variants) {
    const auto median = [&](auto figure) { return MedianOf(variant.runs, figure); };
    const std::vector<double> masks = MaskRow(of, variant);
    const double ate = 100 * median([](const DynamicRun& run) { return Rmse(run.errors.ate); });
    const double first = table.lines.empty() ? ate : table.lines[0].values[0];
    table.lines.push_back(LineOf(
        of, variant.name,
        {ate, ate / first, 100 * median([](const DynamicRun& run) { return Std(run.errors.ate); }),
         100 * median([](const DynamicRun& run) { return Rmse(run.errors.second_trans); }),
         median([](const DynamicRun& run) { return Rmse(run.errors.second_rot); }),
         median([](const DynamicRun& run) { return run.tracked; }),
         median([](const DynamicRun& run) { return run.start < 0 ? kNothing : run.start; }),
         masks[0], masks[3], masks[5], StageMedian(variant, &StageTimes::dynamics)}));
  }
  table.note = std::string("RPE over 1 s. ") + kMedians;
  return table;
}

Table RunTable(const std::vector<DynamicCase>& cases) {
  Table table{"each run",
              {{"ate_rmse", "cm"},
               {"ate_std", "cm"},
               {"rpe_1s_translation_rmse", "cm"},
               {"rpe_1s_rotation_rmse", "deg"},
               {"tracked"},
               {"start"},
               {"mask_iou", "%"}}};
  const auto add = [&](const DynamicCase& of, const std::string& variant,
                       const std::vector<DynamicRun>& runs) {
    for (size_t i = 0; i < runs.size(); ++i) {
      const DynamicRun& run = runs[i];
      table.lines.push_back(
          LineOf(of, variant,
                 {100 * Rmse(run.errors.ate), 100 * Std(run.errors.ate),
                  100 * Rmse(run.errors.second_trans), Rmse(run.errors.second_rot),
                  static_cast<double>(run.tracked), run.start < 0 ? kNothing : run.start,
                  100 * run.masks.mask.mean()}));
      table.lines.back().of.seed = static_cast<int>(i + 1);
    }
  };
  for (const DynamicCase& of : cases) {
    for (const DynamicVariant& variant : of.variants) add(of, variant.name, variant.runs);
    add(of, "off, without people", of.plain);
  }
  table.note = "RPE over 1 s.";
  return table;
}

}  // namespace alidade::bench
