#include "alidade/view/report.h"

#include <algorithm>
#include <cstdint>

#include "alidade/base/print.h"
#include "alidade/base/timing.h"
#include "alidade/view/histogram.h"
#include "alidade/view/page.h"
#include "alidade/view/svg.h"
#include "alidade/view/turnable.h"

namespace alidade {
namespace {

std::string Milliseconds(double value) {
  char text[32];
  PrintTo(text, sizeof(text), "%.2f", value);
  return text;
}

std::string TimingTable(
    const std::vector<std::pair<std::string, std::vector<double>>>& milliseconds) {
  std::string html =
      "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"milliseconds\">\n"
      "<table class=\"numbers\">\n<tr><th>ms</th><th>median</th><th>mean</th><th>p95</th>"
      "<th>max</th><th>count</th></tr>\n";
  for (const auto& [name, samples] : milliseconds) {
    if (samples.empty()) continue;
    const Summary s = Summarise(samples);
    html += "<tr>" + Cell("td", name);
    for (const double value : {s.median, s.mean, s.p95, s.max}) {
      html += Cell("td", Milliseconds(value));
    }
    html += Cell("td", std::to_string(s.count)) + "</tr>\n";
  }
  return html + "</table>\n</div>\n";
}

// One histogram of processing times per stage.
std::string Histograms(
    const std::vector<std::pair<std::string, std::vector<double>>>& milliseconds) {
  std::string html = "<div class=\"stages\">\n";
  for (const auto& [name, samples] : milliseconds) {
    if (samples.empty()) continue;
    html += "<figure>" + DrawHistogram(samples, "ms", "histogram: milliseconds of " + name) +
            Cell("figcaption", name) + "</figure>\n";
  }
  return html +
         "</div>\n<p class=\"soft\">Distribution of the times. Line: median; dashed: 95th "
         "percentile; last bar: all longer times.</p>\n";
}

std::string Timing(const RunReport& report) {
  if (report.milliseconds.empty() || report.milliseconds.front().second.empty()) return "";
  const std::vector<double>& frames = report.milliseconds.front().second;
  return "<h2>Time</h2>\n" + TimingTable(report.milliseconds) + Histograms(report.milliseconds) +
         "<p class=\"soft\">Time for which the caller waits for each frame:</p>\n" +
         DrawSeries(frames, 1.5 * Summarise(frames).p95, "ms");
}

std::string Figure(const ReportPicture& picture) {
  return "<figure>" + PictureHtml(picture) + Cell("figcaption", picture.caption) + "</figure>\n";
}

std::string Shape(const RunReport& report) {
  const bool turnable = !report.cloud.cloud.points.empty();
  if (!turnable && report.shape.empty()) return "";
  // Without further views the cloud consists of the landmarks.
  std::string html = report.shape.empty() ? "<h2>Landmarks</h2>\n" : "<h2>Shape</h2>\n";
  if (!report.on_units.empty())
    html += "<p class=\"soft\">" + EscapeHtml(report.on_units) + "</p>\n";
  if (turnable) html += TurnableHtml(report.cloud, report.cloud_picture, report.unit);
  if (report.shape.empty()) return html;
  html += "<div class=\"shape\">\n";
  for (const ReportPicture& picture : report.shape) html += Figure(picture);
  return html + "</div>\n";
}

std::string Keyframes(const std::vector<ReportKeyframe>& keyframes) {
  if (keyframes.empty()) return "";
  std::string html = "<h2>Keyframes</h2>\n<div class=\"keyframes-shown\">\n";
  for (const ReportKeyframe& keyframe : keyframes) {
    html += "<figure><div>" + PictureHtml(keyframe.features);
    if (!keyframe.depth.bytes.empty()) html += PictureHtml(keyframe.depth);
    html += "</div>" + Cell("figcaption", keyframe.caption) + "</figure>\n";
  }
  return html +
         "</div>\n<p class=\"soft legend\"><span><span class=\"key\" "
         "style=\"background:#1fb6e8\"></span>features matched to a landmark</span> <span><span "
         "class=\"key\" style=\"background:#b9c1ca\"></span>others</span> <span><span "
         "class=\"key\" style=\"background:#d43a2f\"></span>on moving objects</span> <span>depth: "
         "near is bright, far is dark</span></p>\n";
}

std::string Legend(bool with_truth) {
  return std::string(
             "<p class=\"soft legend\"><span><span class=\"key\" "
             "style=\"background:#1a9d50\"></span>start</span> "
             "<span><span class=\"key\" style=\"background:#d43a2f\"></span>end</span> "
             "<span><span class=\"key\" style=\"background:var(--path)\"></span>path and "
             "keyframes</span> "
             "<span><span class=\"key\" style=\"background:var(--dot)\"></span>landmarks"
             "</span>") +
         (with_truth ? " <span>dashed: ground truth</span>" : "") + "</p>\n";
}

// Draws each map from above and from the side.
std::string Maps(const std::vector<ReportMap>& maps) {
  std::string html;
  for (size_t i = 0; i < maps.size(); ++i) {
    const bool many = maps.size() > 1;
    const auto heading = [&](const char* words) {
      return many ? std::string("<h3>") + words + "</h3>\n"
                  : std::string("<h2>") + words + "</h2>\n";
    };
    if (many) {
      html += "<h2>Map " + std::to_string(i + 1) + " of " + std::to_string(maps.size()) +
              "</h2>\n<p class=\"soft\">" + EscapeHtml(maps[i].caption) + "</p>\n";
    }
    const PlaceDrawing& place = maps[i].place;
    html += heading("From above") + "<div class=\"framed\">" + DrawPlace(place, PlaceView::kAbove) +
            "</div>\n";
    if (i == 0) html += Legend(!place.truth.empty());
    html += heading("From the side") + "<div class=\"framed\">" +
            DrawPlace(place, PlaceView::kSide) + "</div>\n";
  }
  return html;
}

// Everything that a user must know before trusting the result.
std::string Banner(const RunReport& report) {
  const std::string lists =
      HtmlList("Lost", report.lost_spans) + HtmlList("Warnings", report.warnings);
  if (report.failure.empty() && lists.empty()) return "";
  std::string html = "<div class=\"banner\" role=\"note\">\n";
  for (const std::string& line : report.failure) html += Cell("p", line) + "\n";
  return html + lists + "</div>\n";
}

std::string Next(const std::vector<ReportStep>& steps) {
  if (steps.empty()) return "";
  std::string html = "<h2>What to do next</h2>\n<dl class=\"next\">\n";
  for (const ReportStep& step : steps)
    html += Cell("dt", step.purpose) + "<dd>" + Cell("code", step.command) + "</dd>\n";
  return html + "</dl>\n";
}

// Sections of later commands are before it.
constexpr char kSectionsEnd[] = "<!-- end of sections -->\n";

}  // namespace

std::string Base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < count ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k)
      text.push_back(k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=');
  }
  return text;
}

std::string WithSection(const std::string& page, const std::string& name, const std::string& html) {
  const std::string begin = "<!-- section " + name + " -->\n",
                    end = "<!-- end of section " + name + " -->\n";
  const size_t last = page.find(kSectionsEnd);
  if (last == std::string::npos) return page;
  size_t from = page.find(begin), to = page.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from || to > last) {
    from = to = last;
  } else {
    to += end.size();
  }
  return page.substr(0, from) + begin + html + end + page.substr(to);
}

std::string RenderReport(const RunReport& report) {
  std::string html = Banner(report);
  html += Shape(report);
  html += kSectionsEnd;
  html += Next(report.next);
  html += report.facts.empty() ? "" : "<h2>The run</h2>\n" + PairTable(report.facts);
  html += Maps(report.maps);
  if (!report.error.empty()) {
    html += "<h2>Distance to the ground truth</h2>\n" +
            DrawCurves({report.error}, report.seconds, "s", "m",
                       "distance to the ground truth over time");
  }
  html += Keyframes(report.keyframes);
  html += "<h2>Frames</h2>\n" + DrawTimeline(report.frames) +
          "<p class=\"soft\"><span class=\"key\" style=\"background:var(--line)\"></span>starting"
          "<span class=\"key\" style=\"background:#1a9d50\"></span>tracked"
          "<span class=\"key\" style=\"background:#d43a2f\"></span>lost</p>\n";
  html += Timing(report);
  html += "<details>\n<summary>Settings</summary>\n" + PairTable(report.settings) + "</details>\n";
  return HtmlPage(report.title, html);
}

}  // namespace alidade
