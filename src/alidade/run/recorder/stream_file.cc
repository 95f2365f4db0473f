#include "alidade/run/recorder/stream_file.h"

#include <cerrno>
#include <cstdint>
#include <cstring>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"

namespace alidade {
namespace {

constexpr std::string_view kMagic = "ALIDSTR1";
constexpr size_t kHeader = 8;

size_t Filling(size_t size) { return (8 - size % 8) % 8; }

}  // namespace

StreamFileWriter::StreamFileWriter(const std::string& path) : file_(path) { file_.Write(kMagic); }

bool StreamFileWriter::Write(std::string_view message) {
  char header[kHeader] = {};
  const auto size = static_cast<uint32_t>(message.size());
  std::memcpy(header, &size, sizeof size);
  constexpr char kZeros[8] = {};
  return file_.Write({header, kHeader}) && file_.Write(message) &&
         file_.Write({kZeros, Filling(message.size())});
}

StreamFileReader::StreamFileReader(const std::string& path) {
  CheckIsFile(path);
  file_ = std::fopen(path.c_str(), "rb");
  if (!file_) ThrowInput(path + ": cannot be read (" + std::strerror(errno) + ")");
  std::fseek(file_, 0, SEEK_END);
  const long size = std::ftell(file_);
  std::rewind(file_);
  char magic[8] = {};
  if (size < 8 || std::fread(magic, 1, 8, file_) != 8 || std::string_view(magic, 8) != kMagic) {
    std::fclose(file_);
    ThrowInput(path + ": is not a recorded stream (`alidade run --record` writes one)");
  }
  left_ = static_cast<size_t>(size) - 8;
}

StreamFileReader::~StreamFileReader() { std::fclose(file_); }

std::optional<std::string> StreamFileReader::Next() {
  char header[kHeader];
  if (left_ < kHeader || std::fread(header, 1, kHeader, file_) != kHeader) return std::nullopt;
  left_ -= kHeader;
  uint32_t size = 0;
  std::memcpy(&size, header, sizeof size);
  if (size > left_) return std::nullopt;
  std::string message(size, '\0');
  const size_t filling = Filling(size);
  char skipped[8];
  if (std::fread(message.data(), 1, size, file_) != size) return std::nullopt;
  left_ -= size;
  if (filling > left_ || std::fread(skipped, 1, filling, file_) != filling) {
    left_ = 0;
  } else {
    left_ -= filling;
  }
  return message;
}

}  // namespace alidade
