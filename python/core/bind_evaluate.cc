#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/choice.h"
#include "alidade/base/error.h"
#include "alidade/evaluation/ate.h"
#include "alidade/evaluation/depth_error.h"
#include "alidade/evaluation/rpe.h"
#include "alidade/run/sources/truth.h"
#include "arrays.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;
using Span = std::optional<std::pair<double, double>>;

std::optional<TimeSpan> SpanFrom(const Span& span) {
  if (!span) return std::nullopt;
  return TimeSpan{span->first, span->second};
}

py::dict ToDict(const ErrorStatistics& s, double scale, double coverage) {
  return py::dict("n"_a = s.n, "rmse"_a = s.rmse, "mean"_a = s.mean, "median"_a = s.median,
                  "std"_a = s.std, "min"_a = s.min, "max"_a = s.max, "scale"_a = scale,
                  "coverage"_a = coverage);
}

py::dict Ate(const py::object& truth, const py::object& estimate, const std::string& align,
             const std::string& sensor, const std::string& association, double max_dt,
             const Span& span) {
  AteSettings settings;
  const ChosenAlignment chosen = AlignmentNamed("align", align, sensor);
  settings.align = chosen.align;
  settings.association = Choice<Association>(
      "association", association, {{"tum", Association::kTum}, {"evo", Association::kEvo}});
  settings.max_dt = max_dt;
  settings.source_span = SpanFrom(span);
  settings.Check();
  const Trajectory true_poses = TrajectoryOf(truth, "truth"),
                   poses = TrajectoryOf(estimate, "estimate");
  AteResult result;
  {
    const py::gil_scoped_release release;
    result = EvaluateAte(true_poses, poses, settings);
  }
  const Sim3& T = result.T_truth_estimate;
  std::vector<int> pairs;
  for (const StampPair& pair : result.pairs) {
    pairs.push_back(pair.truth);
    pairs.push_back(pair.estimate);
  }
  py::dict all = ToDict(result.error, T.s, result.coverage);
  all["align"] = NameOf(chosen.align);
  all["align_why"] = chosen.why;
  all["transform"] = PoseArray(Se3{T.s * T.R, T.t});
  all["pairs"] = Table(pairs, 2);
  all["errors"] = Table(result.distances);
  return all;
}

py::tuple Rpe(const py::object& truth, const py::object& estimate, double delta,
              const std::string& unit, const std::string& pairs, const std::string& align,
              const std::string& sensor, double max_dt, const Span& span) {
  RpeSettings settings;
  settings.delta = delta;
  settings.unit =
      Choice<DeltaUnit>("unit", unit, {{"s", DeltaUnit::kSeconds}, {"frames", DeltaUnit::kFrames}});
  settings.pairs = Choice<PairSelection>(
      "pairs", pairs, {{"all", PairSelection::kAll}, {"consecutive", PairSelection::kConsecutive}});
  const ChosenAlignment chosen = AlignmentNamed("align", align, sensor);
  settings.align = chosen.align;
  settings.max_dt = max_dt;
  settings.source_span = SpanFrom(span);
  settings.Check();
  const Trajectory true_poses = TrajectoryOf(truth, "truth"),
                   poses = TrajectoryOf(estimate, "estimate");
  RpeResult result;
  {
    const py::gil_scoped_release release;
    result = EvaluateRpe(true_poses, poses, settings);
  }
  return py::make_tuple(ToDict(result.trans, result.scale, result.coverage),
                        ToDict(result.rot, result.scale, result.coverage), NameOf(chosen.align),
                        chosen.why);
}

py::dict ToDict(const DepthScore& s) {
  return py::dict("n"_a = s.n, "median_rel"_a = s.median_rel, "p90_rel"_a = s.p90_rel,
                  "within_2"_a = s.within_2, "within_5"_a = s.within_5, "within_10"_a = s.within_10,
                  "rmse_inv"_a = s.rmse_inv, "density"_a = s.density,
                  "density_gradient"_a = s.density_gradient, "edge_coverage"_a = s.edge_coverage,
                  "scale"_a = s.scale);
}

class DepthErrors {
 public:
  explicit DepthErrors(bool fit_scale) : scorer_(SettingsFor(fit_scale)) {}

  void Add(const py::object& estimate, const py::object& truth, const py::object& image, int map) {
    const WrappedImage guess = WrapDepth(estimate, "estimate"),
                       true_depth = WrapDepth(truth, "truth");
    const WrappedImage picture = WrapImage(image, "image");
    const py::gil_scoped_release release;
    scorer_.Add({guess.image, true_depth.image, picture.image, map});
  }
  py::tuple Result() const {
    DepthErrorResult result;
    {
      const py::gil_scoped_release release;
      result = scorer_.Result();
    }
    py::list frames;
    for (const DepthScores& scores : result.frames)
      frames.append(py::make_tuple(ToDict(scores.all), ToDict(scores.continuous)));
    return py::make_tuple(ToDict(result.overall.all), ToDict(result.overall.continuous), frames,
                          Table(result.scales));
  }

 private:
  static DepthErrorSettings SettingsFor(bool fit_scale) {
    DepthErrorSettings settings;
    settings.fit_scale = fit_scale;
    return settings;
  }
  DepthScorer scorer_;
};

}  // namespace

void BindEvaluate(py::module_& core) {
  core.def("ate", &Ate, "truth"_a, "estimate"_a, "align"_a, "sensor"_a, "association"_a, "max_dt"_a,
           "span"_a);
  core.def("rpe", &Rpe, "truth"_a, "estimate"_a, "delta"_a, "unit"_a, "pairs"_a, "align"_a,
           "sensor"_a, "max_dt"_a, "span"_a);
  py::class_<DepthErrors>(core, "DepthErrors")
      .def(py::init<bool>(), "fit_scale"_a)
      .def("add", &DepthErrors::Add, "estimate"_a, "truth"_a, "image"_a, "map"_a)
      .def("result", &DepthErrors::Result);
}

}  // namespace alidade::python
