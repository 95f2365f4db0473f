#include "bench/dynamic_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

// `errors`: which of them; `scale`: to the table's unit.
Table ErrorTable(const std::string& name, const std::vector<DynamicCase>& cases,
                 ErrorStatistics DynamicErrors::*errors, double scale) {
  Table table{name, {}};
  for (const DynamicVariant& variant : cases.front().variants) {
    table.columns.push_back(variant.name);
    table.columns.push_back(variant.name + " Std");
    if (variant.name == "off") continue;
    table.columns.push_back(variant.name + " eta %");
    table.columns.push_back(variant.name + " eta Std %");
  }
  for (const DynamicCase& of : cases) {
    table.labels.push_back(of.label);
    std::vector<double> row;
    double off = kNothing, off_std = kNothing;
    for (const DynamicVariant& variant : of.variants) {
      const double rmse = scale * MedianOf(variant.runs, [&](const DynamicRun& run) {
                            return Rmse(run.errors.*errors);
                          });
      const double std = scale * MedianOf(variant.runs, [&](const DynamicRun& run) {
                           return Std(run.errors.*errors);
                         });
      row.insert(row.end(), {rmse, std});
      if (variant.name == "off") {
        off = rmse;
        off_std = std;
      } else {
        row.insert(row.end(), {Improvement(off, rmse), Improvement(off_std, std)});
      }
    }
    table.rows.push_back(std::move(row));
  }
  table.note = std::string("RMSE and standard deviation; eta = (off - mode) / off. ") + kMedians;
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
      ErrorTable("1. absolute trajectory error, cm", cases, &DynamicErrors::ate, 100),
      ErrorTable("2. relative pose error, translation, every two poses, cm", cases,
                 &DynamicErrors::every_trans, 100),
      ErrorTable("3. relative pose error, rotation, every two poses, degrees", cases,
                 &DynamicErrors::every_rot, 1),
      ErrorTable("2b. relative pose error, translation over 1 s, cm", cases,
                 &DynamicErrors::second_trans, 100),
      ErrorTable("3b. relative pose error, rotation over 1 s, degrees", cases,
                 &DynamicErrors::second_rot, 1),
  };
}

Table CoverageTable(const std::vector<DynamicCase>& cases) {
  Table table{"4. coverage, and what the stages take in the inline schedule",
              {"frames", "tracked", "%", "start", "lost", "maps", "in map 1", "extract ms",
               "track ms", "dynam. ms"}};
  for (const DynamicCase& of : cases) {
    for (const DynamicVariant& variant : of.variants) {
      table.labels.push_back(of.label + " " + variant.name);
      const auto median = [&](auto figure) { return MedianOf(variant.runs, figure); };
      table.rows.push_back(
          {median([](const DynamicRun& run) { return run.frames; }),
           median([](const DynamicRun& run) { return run.tracked; }),
           median([](const DynamicRun& run) { return Percent(run.tracked, run.frames); }),
           median([](const DynamicRun& run) { return run.start < 0 ? kNothing : run.start; }),
           median([](const DynamicRun& run) { return run.lost; }),
           median([](const DynamicRun& run) { return run.maps; }),
           median([](const DynamicRun& r) { return static_cast<double>(r.trajectory.size()); }),
           StageMedian(variant, &StageTimes::extract), StageMedian(variant, &StageTimes::track),
           StageMedian(variant, &StageTimes::dynamics)});
    }
  }
  table.note = std::string("start: number of the first frame with a pose; lost: how often. ") +
               "Errors are those of map 1, the one with the most frames. " + kMedians;
  return table;
}

Table MaskTable(const std::vector<DynamicCase>& cases) {
  Table table{"masks of movers against the true ones, %",
              {"IoU", "det. box", "true box", "static", "kept det", "kept true", "map", "depth"}};
  for (const DynamicCase& of : cases) {
    if (of.people_boxes.frames == 0) continue;
    for (const DynamicVariant& variant : of.variants) {
      table.labels.push_back(of.label + " " + variant.name);
      table.rows.push_back(MaskRow(of, variant));
    }
  }
  table.note =
      "IoU: mean over the frames; of all the area of detected boxes, of true boxes. static: of the "
      "features in use, those not on people. kept: of the features not on people in detected "
      "(true) "
      "boxes, those in use. map, depth: observations of landmarks, semi-dense pixels (with --set "
      "semidense.enabled=1) on people.";
  return table;
}

Table PlainTable(const std::vector<DynamicCase>& cases) {
  Table table{"against the same frames without people: ATE on the frames both have, cm",
              {"plain", "here", "ratio", "more mm", "x 1.05", "x 1.1", "x 1.15", "x 1.3", "x 1.5",
               "x 2", "plain all", "frames"}};
  for (const DynamicCase& of : cases) {
    if (of.plain.empty()) continue;
    for (const DynamicVariant& variant : of.variants) {
      const double plain = Median(variant.ate_plain), here = Median(variant.ate_here);
      std::vector<double> row{100 * plain, 100 * here, here / plain, 1000 * (here - plain)};
      for (const double k : {1.05, 1.1, 1.15, 1.3, 1.5, 2.0})
        row.push_back(100 * std::max(k * plain, plain + 0.005));
      row.push_back(100 *
                    MedianOf(of.plain, [](const DynamicRun& run) { return Rmse(run.errors.ate); }));
      row.push_back(MedianOf(of.plain, [](const DynamicRun& run) { return run.tracked; }));
      table.labels.push_back(of.label + " " + variant.name);
      table.rows.push_back(std::move(row));
    }
  }
  table.note =
      "x k: the limit max(k plain, plain + 5 mm). plain all, frames: of the run without people "
      "alone, with dynamics off.";
  return table;
}

Table VariantTable(const std::string& name, const DynamicCase& of) {
  Table table{name,
              {"ATE cm", "to row 1", "Std", "RPE cm", "RPE deg", "tracked", "start", "IoU %",
               "static %", "kept true", "dynam. ms"}};
  for (const DynamicVariant& variant : of.variants) {
    const auto median = [&](auto figure) { return MedianOf(variant.runs, figure); };
    const std::vector<double> masks = MaskRow(of, variant);
    const double ate = 100 * median([](const DynamicRun& run) { return Rmse(run.errors.ate); });
    const double first = table.rows.empty() ? ate : table.rows[0][0];
    table.labels.push_back(variant.name);
    table.rows.push_back(
        {ate, ate / first, 100 * median([](const DynamicRun& run) { return Std(run.errors.ate); }),
         100 * median([](const DynamicRun& run) { return Rmse(run.errors.second_trans); }),
         median([](const DynamicRun& run) { return Rmse(run.errors.second_rot); }),
         median([](const DynamicRun& run) { return run.tracked; }),
         median([](const DynamicRun& run) { return run.start < 0 ? kNothing : run.start; }),
         masks[0], masks[3], masks[5], StageMedian(variant, &StageTimes::dynamics)});
  }
  table.note = std::string("RPE over 1 s. ") + kMedians;
  return table;
}

Table RunTable(const std::vector<DynamicCase>& cases) {
  Table table{"each run",
              {"seed", "ATE cm", "Std", "RPE cm", "RPE deg", "tracked", "start", "IoU %"}};
  const auto add = [&](const std::string& label, const std::vector<DynamicRun>& runs) {
    for (size_t i = 0; i < runs.size(); ++i) {
      const DynamicRun& run = runs[i];
      table.labels.push_back(label);
      table.rows.push_back({static_cast<double>(i + 1), 100 * Rmse(run.errors.ate),
                            100 * Std(run.errors.ate), 100 * Rmse(run.errors.second_trans),
                            Rmse(run.errors.second_rot), static_cast<double>(run.tracked),
                            run.start < 0 ? kNothing : run.start, 100 * run.masks.mask.mean()});
    }
  };
  for (const DynamicCase& of : cases) {
    for (const DynamicVariant& variant : of.variants)
      add(of.label + " " + variant.name, variant.runs);
    add(of.label + " off, plain", of.plain);
  }
  table.note = "RPE over 1 s.";
  return table;
}

}  // namespace alidade::bench
