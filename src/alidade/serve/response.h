// What is answered over HTTP: heads with what browsers are forbidden, and the files compiled in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// The strictest that the page runs with: own scripts, styles, icon and stream, and nothing else.
inline constexpr std::string_view kContentPolicy =
    "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "require-trusted-types-for 'script'; trusted-types 'none'";

// The page for phones besides: WebAssembly, Workers, pictures and videos that it makes itself.
inline constexpr std::string_view kPhonePolicy =
    "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src 'self'; "
    "img-src 'self' blob: data:; media-src 'self' blob:; connect-src 'self'; manifest-src 'self'";

enum class Site { kViewer, kPhone };

// `length`: bytes of the body, compressed if it is. Nothing is kept in a browser's cache: the next
// program at this address may be another version.
std::string ResponseHead(int status, std::string_view type, uint64_t length, bool keep_alive,
                         bool gzipped = false, Site site = Site::kViewer);

// Whether a request whose Accept-Encoding is `accepted` may be answered compressed.
bool AcceptsGzip(std::string_view accepted);

struct PageFile {
  std::string_view name;  // index.html; index.html.gz is the same compressed
  std::string_view bytes;
};

// Made by cmake/EmbedPage.cmake; empty when the page was not built.
const std::vector<PageFile>& PageFiles();
const std::vector<PageFile>& PhoneFiles();  // the page for phones

struct Answer {
  std::string_view type;
  std::string_view bytes;
  bool gzipped = false;
};

// The file at "/" or "/name", compressed where it may be and is there; at "/" a plain page when the
// page was not built.
std::optional<Answer> FindPage(std::string_view path, const std::vector<PageFile>& files,
                               bool may_gzip = false);

std::string_view TypeOf(std::string_view name);  // text/javascript; charset=utf-8

// The file of the core (WebAssembly) at "/core/single/alidade.wasm" and the like, below `folder`,
// as it was built or installed; empty when the path is not one of these or the file is not there.
std::string FindCore(std::string_view path, const std::string& folder);

}  // namespace alidade
