#include "alidade/serve/response.h"

#include <array>
#include <utility>

namespace alidade {
namespace {

constexpr std::string_view kPlainPage = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark"><title>Alidade</title></head><body>
<h1>Alidade</h1>
<p>The viewer's page was not built into this program: it needs Node.js 18 or later with npm, which were
not found, or failed, when the program was built.</p>
<p><code>scripts/setup</code> installs them; <code>scripts/build</code> then builds the program with the page.
The run itself goes on, and its results are written as always.</p>
</body></html>
)";

std::string_view Words(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 413:
      return "Payload Too Large";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

std::string_view TypeOf(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kTypes = {
      {{"html", "text/html; charset=utf-8"},
       {"js", "text/javascript; charset=utf-8"},
       {"css", "text/css; charset=utf-8"},
       {"svg", "image/svg+xml"},
       {"txt", "text/plain; charset=utf-8"},
       {"wasm", "application/wasm"}}};
  const std::string_view ending = name.substr(name.rfind('.') + 1);
  for (const auto& [known, type] : kTypes) {
    if (ending == known) return type;
  }
  return "application/octet-stream";
}

}  // namespace

std::string ResponseHead(int status, std::string_view type, uint64_t length, bool keep_alive) {
  std::string head = "HTTP/1.1 " + std::to_string(status) + " ";
  const auto line = [&](std::string_view name, std::string_view value) {
    head.append(name).append(": ").append(value).append("\r\n");
  };
  head.append(Words(status)).append("\r\n");
  line("Content-Type", type);
  line("Content-Length", std::to_string(length));
  line("Connection", keep_alive ? "keep-alive" : "close");
  line("Cache-Control", "no-store");
  line("Content-Security-Policy", kContentPolicy);
  line("X-Content-Type-Options", "nosniff");
  line("Referrer-Policy", "no-referrer");
  line("Cross-Origin-Resource-Policy", "same-origin");
  if (status == 405) line("Allow", "GET, HEAD");
  return head + "\r\n";
}

std::optional<Answer> FindPage(std::string_view path, const std::vector<PageFile>& files) {
  if (path.empty() || path.front() != '/') return std::nullopt;
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  for (const PageFile& file : files) {
    if (file.name == name) return Answer{TypeOf(name), file.bytes};
  }
  if (name == "index.html") return Answer{TypeOf(name), kPlainPage};
  return std::nullopt;
}

}  // namespace alidade
