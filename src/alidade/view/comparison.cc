#include "alidade/view/comparison.h"

#include <algorithm>
#include <numeric>

#include "alidade/view/page.h"
#include "alidade/view/svg.h"

namespace alidade {
namespace {

std::string Chip(const ComparedRun& run, size_t number) {
  return "<span class=\"chip " + ClassOfRun(number) + "\"></span>" + EscapeHtml(run.name);
}

// Runs beside each other in one table; more are in further tables below.
constexpr size_t kColumns = 6;

std::string MeasuresOfRuns(const RunComparison& comparison, size_t begin, size_t end) {
  const std::string runs =
      begin == 0 && end == comparison.runs.size()
          ? ""
          : " of runs " + std::to_string(begin + 1) + " to " + std::to_string(end);
  std::string html = "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"figures" +
                     runs +
                     "\">\n"
                     "<table class=\"compared\">\n<thead><tr><td></td>";
  for (size_t i = begin; i < end; ++i)
    html += "<th scope=\"col\">" + Chip(comparison.runs[i], i) + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (size_t row = 0; row < comparison.measures.size(); ++row) {
    html += "<tr><th scope=\"row\">" + EscapeHtml(comparison.measures[row]) + "</th>";
    // Narrow screens show the cells one below the other, each with its run.
    for (size_t i = begin; i < end; ++i) {
      html += "<td class=\"" + ClassOfRun(i) + "\" data-run=\"" +
              EscapeHtml(comparison.runs[i].name) + "\">" +
              EscapeHtml(comparison.runs[i].values[row]) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n</div>\n";
}

std::string Measures(const RunComparison& comparison) {
  std::string html;
  const size_t count = comparison.runs.size();
  for (size_t begin = 0; begin < count; begin += kColumns)
    html += MeasuresOfRuns(comparison, begin, std::min(begin + kColumns, count));
  return html;
}

std::string Names(const RunComparison& comparison, const std::vector<size_t>& runs) {
  std::string html;
  for (const size_t i : runs) html += "<span>" + Chip(comparison.runs[i], i) + "</span> ";
  return html;
}

std::string AllNames(const RunComparison& comparison) {
  std::vector<size_t> all(comparison.runs.size());
  std::iota(all.begin(), all.end(), size_t{0});
  return "<p class=\"soft legend\">" + Names(comparison, all) + "</p>\n";
}

constexpr char kEnds[] =
    "<span><span class=\"key\" style=\"background:#1a9d50;margin-left:0\"></span>start</span> "
    "<span><span class=\"key\" style=\"background:#d43a2f;margin-left:0\"></span>end</span>";

std::string DrawPlace(const RunComparison& comparison, const ComparedPlace& place, PlaceView view) {
  std::vector<DrawnPath> paths(comparison.runs.size());  // the others stay empty: colors by run
  for (const size_t i : place.runs) paths[i] = comparison.runs[i].path;
  return "<figure>\n<div class=\"framed\">" + DrawPaths(paths, place.truth, view, place.unit) +
         "</div>\n<figcaption class=\"legend\">" + Names(comparison, place.runs) +
         (place.truth.empty() ? "" : "<span>dashed: ground truth</span> ") + kEnds +
         "</figcaption>\n</figure>\n";
}

std::string Paths(const RunComparison& comparison) {
  const auto drawn = [&](PlaceView view) {
    std::string html;
    for (const ComparedPlace& place : comparison.places) html += DrawPlace(comparison, place, view);
    return comparison.places.size() > 1 ? "<div class=\"stages places\">\n" + html + "</div>\n"
                                        : html;
  };
  if (comparison.places.empty()) return "";
  return "<h2>From above</h2>\n" + drawn(PlaceView::kAbove) + "<h2>From the side</h2>\n" +
         drawn(PlaceView::kSide);
}

std::string Errors(const RunComparison& comparison) {
  std::vector<Curve> curves;
  bool any = false;
  for (const ComparedRun& run : comparison.runs) {
    curves.push_back(run.error);
    any = any || !run.error.empty();
  }
  if (!any) return "";
  return "<h2>Distance to the ground truth</h2>\n" +
         DrawCurves(curves, comparison.seconds, "s", "m",
                    "distance to the ground truth over time") +
         AllNames(comparison);
}

std::string Stage(const RunComparison& comparison, size_t stage) {
  std::vector<std::string> names;
  std::vector<MedianBar> bars;
  for (const ComparedRun& run : comparison.runs) {
    names.push_back(run.name);
    bars.push_back(run.milliseconds[stage]);
  }
  if (std::all_of(bars.begin(), bars.end(), [](const MedianBar& b) { return b.median < 0; }))
    return "";
  return "<h3>" + EscapeHtml(comparison.stages[stage]) + "</h3>\n" + DrawMedians(names, bars, "ms");
}

std::string Times(const RunComparison& comparison) {
  if (comparison.stages.empty()) return "";
  std::string more;
  for (size_t stage = 1; stage < comparison.stages.size(); ++stage)
    more += Stage(comparison, stage);
  return "<h2>Milliseconds</h2>\n<p class=\"soft\">Full color: up to the median; lighter: up to "
         "the 95th percentile. Each stage has its own scale.</p>\n" +
         Stage(comparison, 0) + "<details>\n<summary>Parts</summary>\n" + more + "</details>\n";
}

}  // namespace

std::string RenderComparison(const RunComparison& comparison) {
  std::vector<std::string> names;
  std::vector<std::vector<FateSpan>> fates;
  for (const ComparedRun& run : comparison.runs) {
    names.push_back(run.name);
    fates.push_back(run.fates);
  }
  std::string body = Measures(comparison);
  if (!comparison.notes.empty()) body += HtmlList("Notes", comparison.notes);
  body += Paths(comparison) + Errors(comparison);
  body += "<h2>Frames</h2>\n" + DrawSpans(names, fates, comparison.seconds) +
          "<p class=\"soft\"><span class=\"key\" style=\"background:var(--line)\"></span>starting"
          "<span class=\"key\" style=\"background:#1a9d50\"></span>tracked"
          "<span class=\"key\" style=\"background:#d43a2f\"></span>lost</p>\n";
  body += Times(comparison);
  return HtmlPage(std::to_string(comparison.runs.size()) + " runs compared", body);
}

}  // namespace alidade
