#include "alidade/view/page.h"

#include "alidade/view/svg.h"

namespace alidade {
namespace {

constexpr char kStyle[] = R"(<style>
:root{color-scheme:light dark;--ink:#1b1f24;--page:#fff;--soft:#6b7480;--line:#d8dde3;--path:#0b6fd1;--dot:#5c6875;
--run0:#0072b2;--run1:#c04f00;--run2:#00805c;--run3:#a8478a;--run4:#8a6d00;--run5:#5b5fc7}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ed;--page:#14171b;--soft:#98a2ad;--line:#333a42;--path:#5aa9ff;--dot:#98a3ae;
--run0:#5ab4e8;--run1:#ff8a3d;--run2:#2fc79b;--run3:#e08fc2;--run4:#e5b83a;--run5:#a5a8ff}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--page);max-width:940px;margin:2rem auto;padding:0 1rem}
h1{font-size:1.5rem;margin:0 0 .2rem}h2{font-size:1.1rem;margin:2rem 0 .5rem}h3{font-size:1rem;margin:1.2rem 0 .4rem}
.soft{color:var(--soft)}svg{width:100%;height:auto;display:block}.framed{border:1px solid var(--line);border-radius:6px}
table{border-collapse:collapse}td,th{padding:.15rem 1.2rem .15rem 0;text-align:left;vertical-align:top}
th{font-weight:600;color:var(--soft)}.numbers td+td,.numbers th+th{text-align:right;font-variant-numeric:tabular-nums}
text{font-size:12px;fill:var(--soft);stroke:var(--page);stroke-width:3px;paint-order:stroke}
@media(max-width:600px){text{font-size:24px}td,th{padding-right:.8rem}}
.wide{overflow-x:auto}table:not([class]) td{overflow-wrap:anywhere}details table:not([class]) th{overflow-wrap:anywhere;min-width:9em}path,polyline{fill:none;stroke-linecap:round;stroke-linejoin:round}
.landmarks{stroke:var(--dot);stroke-width:2.4;opacity:.75}.path{stroke:var(--path);stroke-width:2}
.keyframes{stroke:var(--path);stroke-width:6}.scale{stroke:var(--soft);stroke-width:2}
.start{fill:#1a9d50}.end{fill:#d43a2f}.tracked{fill:#1a9d50}.lost{fill:#d43a2f}.starting{fill:var(--line)}
.grid{stroke:var(--line)}.series{stroke:var(--path)}
.shape{display:grid;grid-template-columns:repeat(3,1fr);gap:.6rem}img{width:100%;display:block;border-radius:6px}
.turn canvas,.turn .live{display:none}.turn.on canvas{display:block;width:100%;aspect-ratio:3/2;border:1px solid var(--line);border-radius:6px;
box-sizing:border-box;cursor:grab;touch-action:pan-y}.turn.on img,.turn.on .still{display:none}.turn.on .live{display:block;margin:.4rem 0 1rem}
.turn{position:relative}.turn.on .measure{position:absolute;left:14px;top:10px;margin:0;border-bottom:2px solid var(--soft);color:var(--soft);
font-size:13px;white-space:nowrap;pointer-events:none}
.turn canvas:focus-visible{outline:2px solid var(--path)}button{font:inherit;color:inherit;background:none;border:1px solid var(--line);border-radius:4px;padding:.1em .6em;cursor:pointer}
.keyframes-shown{display:grid;grid-template-columns:1fr 1fr;gap:1rem 1.6rem}.keyframes-shown div{display:flex;gap:4px}.keyframes-shown img{flex:1;min-width:0;border-radius:3px}
figure{margin:0}figcaption{color:var(--soft)}.stages{display:grid;grid-template-columns:1fr 1fr;gap:1rem 1.6rem;margin-top:1rem}
.stages text{font-size:13px}.stages.places text{font-size:26px}.bar{fill:var(--path);opacity:.75}.median,.p95{stroke:var(--ink);stroke-width:1.5}.p95{stroke-dasharray:4 3}
@media(max-width:600px){.stages{grid-template-columns:1fr}.stages text{font-size:15px}.shape,.keyframes-shown{grid-template-columns:1fr}.turn.on canvas{aspect-ratio:1}}
.key{display:inline-block;width:.7em;height:.7em;border-radius:50%;margin:0 .3em 0 1em}.key:first-child{margin-left:0}
.run0{--own:var(--run0)}.run1{--own:var(--run1)}.run2{--own:var(--run2)}.run3{--own:var(--run3)}.run4{--own:var(--run4)}.run5{--own:var(--run5)}
.curve{stroke:var(--own);stroke-width:2}.truth{stroke:var(--ink);stroke-width:1.5;stroke-dasharray:5 4}
.again{stroke-dasharray:9 4}.half{fill:var(--own)}.rest{fill:var(--own);opacity:.4}.mark{stroke:var(--own);stroke-width:2}
.compared{margin-bottom:1.5rem}.compared td,.compared thead th{font-variant-numeric:tabular-nums;overflow-wrap:anywhere}.compared tbody td{min-width:5.5em}.compared th:first-child,.compared td:first-child{white-space:nowrap;position:sticky;left:0;background:var(--page)}
.chip{display:inline-block;width:.8em;height:.8em;border-radius:2px;margin-right:.4em;background:var(--own)}
.legend>span{margin-right:1.2em;white-space:nowrap}.legend .key{margin-left:0}
.banner{border-left:4px solid #d43a2f;background:color-mix(in srgb,#d43a2f 8%,var(--page));padding:.4rem 1rem;margin:1rem 0;border-radius:0 6px 6px 0}
.banner p{margin:.3rem 0;font-weight:600}.banner h2{margin:.5rem 0 .2rem}.banner ul{margin:.2rem 0 .5rem;padding-left:1.2rem}
.next dd{margin:0 0 .6rem}code{font:13px/1.5 ui-monospace,monospace;background:color-mix(in srgb,var(--line) 40%,var(--page));border-radius:4px;padding:.1em .4em;overflow-wrap:anywhere}
@media(max-width:600px){.compared thead{display:none}.compared,.compared tbody,.compared tr,.compared th,.compared tbody td{display:block}
.compared tbody th{padding-top:.7rem}.compared tbody td{display:flex;gap:1rem;justify-content:space-between;padding:0 0 0 .6em;border-left:.3em solid var(--own)}
.compared tbody td::before{content:attr(data-run);color:var(--soft)}}
summary{cursor:pointer;font-weight:600}details{margin-top:2rem}
</style>
)";

}  // namespace

std::string HtmlPage(const std::string& title, const std::string& body) {
  return "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" "
         "content=\"width=device-width,initial-scale=1\">\n<title>Alidade: " +
         EscapeHtml(title) + "</title>\n" + kStyle + "<main>\n<h1>" + EscapeHtml(title) +
         "</h1>\n" + body + "</main>\n</html>\n";
}

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

std::string HtmlList(const std::string& heading, const std::vector<std::string>& items) {
  if (items.empty()) return "";
  std::string html = "<h2>" + heading + "</h2>\n<ul>\n";
  for (const std::string& item : items) html += Cell("li", item) + "\n";
  return html + "</ul>\n";
}

}  // namespace alidade
