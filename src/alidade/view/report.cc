#include "alidade/view/report.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "alidade/base/timing.h"

namespace alidade {
namespace {

constexpr char kStyle[] = R"(<style>
:root{color-scheme:light dark;--ink:#1b1f24;--page:#fff;--soft:#6b7480;--line:#d8dde3;--path:#0b6fd1;--dot:#8a94a0}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ed;--page:#14171b;--soft:#98a2ad;--line:#333a42;--path:#5aa9ff;--dot:#77818c}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--page);max-width:940px;margin:2rem auto;padding:0 1rem}
h1{font-size:1.5rem;margin:0 0 .2rem}h2{font-size:1.1rem;margin:2rem 0 .5rem}
.soft{color:var(--soft)}svg{width:100%;height:auto;display:block}.framed{border:1px solid var(--line);border-radius:6px}
table{border-collapse:collapse}td,th{padding:.15rem 1.2rem .15rem 0;text-align:left;vertical-align:top}
th{font-weight:600;color:var(--soft)}.numbers td+td,.numbers th+th{text-align:right;font-variant-numeric:tabular-nums}
text{font-size:12px;fill:var(--soft)}path,polyline{fill:none;stroke-linecap:round;stroke-linejoin:round}
.landmarks{stroke:var(--dot);stroke-width:1.6;opacity:.7}.path{stroke:var(--path);stroke-width:2}
.keyframes{stroke:var(--path);stroke-width:6}.scale{stroke:var(--soft);stroke-width:2}
.start{fill:#1a9d50}.end{fill:#d43a2f}.tracked{fill:#1a9d50}.lost{fill:#d43a2f}.starting{fill:var(--line)}
.grid{stroke:var(--line)}.series{stroke:var(--path)}
.shape{display:grid;grid-template-columns:repeat(3,1fr);gap:.6rem}.shape figure{margin:0}
.shape figure:first-child{grid-column:1/-1}.shape img{width:100%;display:block;border-radius:6px}
.key{display:inline-block;width:.7em;height:.7em;border-radius:50%;margin:0 .3em 0 1em}.key:first-child{margin-left:0}
summary{cursor:pointer;font-weight:600}details{margin-top:2rem}
</style>
)";

std::string Cell(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + EscapeHtml(text) + "</" + tag + ">";
}

std::string PairTable(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string html = "<table>\n";
  for (const auto& [name, value] : rows) {
    html += "<tr>" + Cell("th", name) + Cell("td", value) + "</tr>\n";
  }
  return html + "</table>\n";
}

std::string List(const std::string& heading, const std::vector<std::string>& items) {
  if (items.empty()) return "";
  std::string html = "<h2>" + heading + "</h2>\n<ul>\n";
  for (const std::string& item : items) html += Cell("li", item) + "\n";
  return html + "</ul>\n";
}

std::string Milliseconds(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", value);
  return text;
}

std::string TimingTable(
    const std::vector<std::pair<std::string, std::vector<double>>>& milliseconds) {
  std::string html =
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
  return html + "</table>\n";
}

std::string Timing(const RunReport& report) {
  if (report.milliseconds.empty() || report.milliseconds.front().second.empty()) return "";
  const std::vector<double>& frames = report.milliseconds.front().second;
  return "<h2>Time</h2>\n" + TimingTable(report.milliseconds) +
         "<p class=\"soft\">Each frame, as its caller waits:</p>\n" +
         DrawSeries(frames, 1.5 * Summarise(frames).p95, "ms");
}

std::string Shape(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return "";
  std::string html = "<h2>Shape</h2>\n<div class=\"shape\">\n";
  for (const ReportPicture& picture : pictures) {
    const std::string caption = EscapeHtml(picture.caption);
    html += "<figure><img alt=\"";
    html += caption;
    html += "\" src=\"data:";
    html += picture.type;
    html += ";base64,";
    html += Base64(picture.bytes);
    html += "\"><figcaption class=\"soft\">";
    html += caption;
    html += "</figcaption></figure>\n";
  }
  return html + "</div>\n";
}

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

std::string RenderReport(const RunReport& report) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>Alidade: " +
      EscapeHtml(report.title) + "</title>\n" + kStyle + "<h1>" + EscapeHtml(report.title) +
      "</h1>\n" + PairTable(report.facts);
  html += List("Warnings", report.warnings);
  html += "<h2>From above</h2>\n<div class=\"framed\">" + DrawFromAbove(report.place) +
          "</div>\n<p class=\"soft\"><span class=\"key\" style=\"background:#1a9d50\"></span>start"
          "<span class=\"key\" style=\"background:#d43a2f\"></span>end"
          "<span class=\"key\" style=\"background:var(--path)\"></span>path and keyframes"
          "<span class=\"key\" style=\"background:var(--dot)\"></span>landmarks</p>\n";
  html += Shape(report.shape);
  html += "<h2>Frames</h2>\n" + DrawTimeline(report.frames) +
          "<p class=\"soft\"><span class=\"key\" style=\"background:var(--line)\"></span>starting"
          "<span class=\"key\" style=\"background:#1a9d50\"></span>tracked"
          "<span class=\"key\" style=\"background:#d43a2f\"></span>lost</p>\n";
  html += List("Lost", report.lost_spans);
  html += Timing(report);
  html += "<details>\n<summary>Settings</summary>\n" + PairTable(report.settings) + "</details>\n";
  return html + "</html>\n";
}

}  // namespace alidade
