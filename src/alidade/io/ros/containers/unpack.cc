#include "alidade/io/ros/containers/unpack.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <new>

#include "alidade/base/error.h"

namespace alidade {
namespace {

// Output buffer that doubles when full, up to a limit.
class Output {
 public:
  Output(size_t packed, uint64_t most) : most_(most) {
    bytes_.resize(std::min<uint64_t>(std::max<size_t>(4 * packed, 4096), most));
  }
  char* at() { return bytes_.data() + used_; }
  // Number of free bytes, at least one. Throws Error (input) when the limit is reached.
  size_t room() {
    if (used_ == bytes_.size()) {
      if (used_ >= most_) ThrowInput("unpacks to more than " + std::to_string(most_ >> 20) + " MB");
      bytes_.resize(std::min<uint64_t>(2 * uint64_t{used_}, most_));
    }
    return bytes_.size() - used_;
  }
  void Used(size_t count) { used_ += count; }
  std::string Done() {
    bytes_.resize(used_);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
  size_t used_ = 0;
  uint64_t most_;
};

[[noreturn]] void ThrowDamaged(const std::string& format) {
  ThrowInput("is damaged: its " + format + " data cannot be decompressed");
}

std::string UnpackBz2(std::string_view packed, uint64_t most) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(packed.data());
  stream.avail_in = static_cast<unsigned>(packed.size());
  Output output(packed.size(), most);
  for (int result = BZ_OK; result != BZ_STREAM_END;) {
    const size_t room = std::min<size_t>(output.room(), std::numeric_limits<int>::max());
    stream.next_out = output.at();
    stream.avail_out = static_cast<unsigned>(room);
    const unsigned before = stream.avail_in;
    result = BZ2_bzDecompress(&stream);
    const size_t made = room - stream.avail_out;
    output.Used(made);
    if (result != BZ_OK && result != BZ_STREAM_END) ThrowDamaged("bz2");
    if (result == BZ_OK && made == 0 && stream.avail_in == before) ThrowDamaged("bz2");
  }
  return output.Done();
}

std::string UnpackLz4(std::string_view packed, uint64_t most) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      created, LZ4F_freeDecompressionContext);
  Output output(packed.size(), most);
  while (true) {
    size_t made = output.room(), taken = packed.size();
    const size_t hint =
        LZ4F_decompress(context.get(), output.at(), &made, packed.data(), &taken, nullptr);
    if (LZ4F_isError(hint)) ThrowDamaged("lz4");
    output.Used(made);
    packed.remove_prefix(taken);
    if (hint == 0 && packed.empty()) return output.Done();
    if (made == 0 && taken == 0) ThrowDamaged("lz4");
  }
}

std::string UnpackZstd(std::string_view packed, uint64_t most) {
  const std::unique_ptr<ZSTD_DStream, size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                        ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  // 128 MB window, zstd's default limit.
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, 27);
  Output output(packed.size(), most);
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  while (true) {
    // Must come before at(), because it may reallocate the buffer.
    const size_t room = output.room();
    ZSTD_outBuffer out{output.at(), room, 0};
    const size_t before = in.pos;
    const size_t hint = ZSTD_decompressStream(stream.get(), &out, &in);
    if (ZSTD_isError(hint)) ThrowDamaged("zstd");
    output.Used(out.pos);
    if (hint == 0 && in.pos == in.size) return output.Done();
    if (out.pos == 0 && in.pos == before) ThrowDamaged("zstd");
  }
}

}  // namespace

std::string Unpack(std::string_view format, std::string_view packed, uint64_t most) {
  if (packed.size() > kMostUnpacked) ThrowInput("is too long for a chunk");
  if (format.empty() || format == "none") return std::string(packed);
  if (format == "bz2") return UnpackBz2(packed, most);
  if (format == "lz4") return UnpackLz4(packed, most);
  if (format == "zstd") return UnpackZstd(packed, most);
  ThrowInput("is compressed by `" + std::string(format.substr(0, 20)) +
             "`; supported are bz2, lz4 and zstd");
}

uint64_t MostUnpackedFrom(uint64_t packed) {
  return std::min(kMostUnpacked, MostUnpackedFileFrom(packed));
}

uint64_t MostUnpackedFileFrom(uint64_t packed) {
  constexpr uint64_t kAlways = uint64_t{1} << 26;
  return std::max(kAlways, packed * kMostFileRatio);
}

bool LooksLikeZstd(std::string_view bytes) { return bytes.substr(0, 4) == "\x28\xb5\x2f\xfd"; }

}  // namespace alidade
