// What is answered over HTTP: heads with what browsers are forbidden, and the files compiled in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// The strictest that the page runs with; workers and WebAssembly are the phone's page's.
inline constexpr std::string_view kContentPolicy =
    "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' blob:; "
    "connect-src 'self'; worker-src 'self'; require-trusted-types-for 'script'; trusted-types w";

// `length`: bytes of the body. Nothing is kept in a browser's cache: the next program at this
// address may be another version.
std::string ResponseHead(int status, std::string_view type, uint64_t length, bool keep_alive);

struct PageFile {
  std::string_view name;  // index.html
  std::string_view bytes;
};

// Made by cmake/EmbedPage.cmake; empty when the page was not built.
const std::vector<PageFile>& PageFiles();

struct Answer {
  std::string_view type;
  std::string_view bytes;
};

// The file at "/" or "/name"; at "/" a plain page when the page was not built.
std::optional<Answer> FindPage(std::string_view path, const std::vector<PageFile>& files);

}  // namespace alidade
