#include "alidade/run/recorder/mcap_log.h"

#include <stdexcept>
#include <string_view>

#ifdef ALIDADE_ZSTD
#include <zstd.h>
#endif

namespace alidade {
namespace {

McapCompression ChunkCompression() {
#ifdef ALIDADE_ZSTD
  return {"zstd", [](std::string_view plain) {
            constexpr int kLevel = 3;  // zstd's own default: 300 MB/s
            std::string packed(ZSTD_compressBound(plain.size()), '\0');
            const size_t size =
                ZSTD_compress(packed.data(), packed.size(), plain.data(), plain.size(), kLevel);
            // cannot happen except without memory, since the buffer is large enough
            if (ZSTD_isError(size) != 0)
              throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
            packed.resize(size);
            return packed;
          }};
#else
  return {};
#endif
}

}  // namespace

McapLog::McapLog(const std::string& path, const std::string& program)
    : file_(path),
      sink_([this](std::string_view bytes) { good_ = file_.Write(bytes); }, ChunkCompression(),
            program),
      log_([this](const char* topic, RosType type, double time, const std::string& message) {
        sink_.Write(topic, type, time, message);
      }) {}

void McapLog::Close() {
  sink_.Close();
  file_.Close();
}

}  // namespace alidade
