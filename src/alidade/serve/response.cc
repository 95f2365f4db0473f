#include "alidade/serve/response.h"

#include <algorithm>
#include <array>
#include <filesystem>
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
    case 411:
      return "Length Required";
    case 413:
      return "Payload Too Large";
    case 415:
      return "Unsupported Media Type";
    case 422:
      return "Unprocessable Content";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

constexpr std::array<std::string_view, 11> kCoreFiles = {"single/alidade.mjs",
                                                         "single/alidade.wasm",
                                                         "threads/alidade.mjs",
                                                         "threads/alidade.wasm",
                                                         "threads/alidade.worker.js",
                                                         "detector/alidade_detector.mjs",
                                                         "detector/alidade_detector.wasm",
                                                         "detector/ort.wasm.min.mjs",
                                                         "detector/ort-wasm-simd-threaded.mjs",
                                                         "detector/ort-wasm-simd-threaded.wasm",
                                                         "detector/onnxruntime-licence.txt"};

}  // namespace

std::string_view TypeOf(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTypes = {
      {{"html", "text/html; charset=utf-8"},
       {"js", "text/javascript; charset=utf-8"},
       {"css", "text/css; charset=utf-8"},
       {"svg", "image/svg+xml"},
       {"txt", "text/plain; charset=utf-8"},
       {"wasm", "application/wasm"},
       {"mjs", "text/javascript; charset=utf-8"},
       {"webmanifest", "application/manifest+json"}}};
  const std::string_view ending = name.substr(name.rfind('.') + 1);
  for (const auto& [known, type] : kTypes) {
    if (ending == known) return type;
  }
  return "application/octet-stream";
}

std::string FindCore(std::string_view path, const std::string& folder) {
  constexpr std::string_view kBegin = "/core/";
  if (folder.empty() || path.substr(0, kBegin.size()) != kBegin) return {};
  const std::string_view name = path.substr(kBegin.size());
  if (std::find(kCoreFiles.begin(), kCoreFiles.end(), name) == kCoreFiles.end()) return {};
  namespace fs = std::filesystem;
  const fs::path installed = fs::path(folder) / name;
  const fs::path built =
      fs::path(folder) / name.substr(0, name.find('/')) / "bin" / name.substr(name.find('/') + 1);
  std::error_code error;
  for (const fs::path& file : {installed, built}) {
    if (fs::is_regular_file(file, error)) return file.string();
  }
  return {};
}

std::string ResponseHead(int status, std::string_view type, uint64_t length, bool keep_alive,
                         bool gzipped, Site site) {
  std::string head = "HTTP/1.1 " + std::to_string(status) + " ";
  const auto line = [&](std::string_view name, std::string_view value) {
    head.append(name).append(": ").append(value).append("\r\n");
  };
  head.append(Words(status)).append("\r\n");
  line("Content-Type", type);
  line("Content-Length", std::to_string(length));
  if (gzipped) line("Content-Encoding", "gzip");
  line("Connection", keep_alive ? "keep-alive" : "close");
  line("Cache-Control", "no-store");
  line("Content-Security-Policy", site == Site::kPhone  ? kPhonePolicy
                                  : site == Site::kPost ? kPostPolicy
                                                        : kContentPolicy);
  if (site == Site::kPhone) {
    // Cross-origin isolation is required for threads. Only the page itself may use the sensors.
    line("Cross-Origin-Opener-Policy", "same-origin");
    line("Cross-Origin-Embedder-Policy", "require-corp");
    line("Permissions-Policy",
         "camera=(self), accelerometer=(self), gyroscope=(self), magnetometer=(self)");
  }
  line("X-Content-Type-Options", "nosniff");
  line("Referrer-Policy", "no-referrer");
  line("Cross-Origin-Resource-Policy", "same-origin");
  if (status == 405) line("Allow", site == Site::kPost ? "GET, HEAD, POST" : "GET, HEAD");
  if (status == 503) line("Retry-After", "1");
  return head + "\r\n";
}

bool AcceptsGzip(std::string_view accepted) {
  while (!accepted.empty()) {
    const size_t comma = accepted.find(',');
    std::string one;
    for (const char c : accepted.substr(0, comma)) {
      if (c != ' ' && c != '\t') one += c;
    }
    accepted.remove_prefix(comma == std::string_view::npos ? accepted.size() : comma + 1);
    if (one == "gzip") return true;
    if (one.rfind("gzip;q=", 0) == 0)  // a quality of 0, 0.0, 0.00 or 0.000 means refused
      return one.find_first_of("123456789", 7) != std::string::npos;
  }
  return false;
}

std::optional<Answer> FindPage(std::string_view path, const std::vector<PageFile>& files,
                               bool may_gzip) {
  if (path.empty() || path.front() != '/') return std::nullopt;
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  constexpr std::string_view kGzipped = ".gz";
  const auto find = [&files](const std::string& wanted) -> const PageFile* {
    for (const PageFile& file : files) {
      if (file.name == wanted) return &file;
    }
    return nullptr;
  };
  const bool own =
      name.size() < kGzipped.size() || name.substr(name.size() - kGzipped.size()) != kGzipped;
  const PageFile* plain = own ? find(std::string(name)) : nullptr;
  if (plain) {
    const PageFile* small = may_gzip ? find(std::string(name) + ".gz") : nullptr;
    return Answer{TypeOf(name), (small ? small : plain)->bytes, small != nullptr};
  }
  if (name == "index.html") return Answer{TypeOf(name), kPlainPage};
  return std::nullopt;
}

}  // namespace alidade
