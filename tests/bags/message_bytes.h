// Writers of sensor_msgs messages for ROS 1 and as CDR, implemented from the formats'
// specifications, independently of the readers.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace alidade {

class MessageBytes {
 public:
  explicit MessageBytes(bool cdr, bool big_endian = false) : cdr_(cdr), big_endian_(big_endian) {
    if (cdr_) head_ = std::string({'\0', big_endian ? '\0' : '\1', '\0', '\0'});
  }

  MessageBytes& U8(uint8_t value) {
    body_ += static_cast<char>(value);
    return *this;
  }
  MessageBytes& U32(uint32_t value) { return Number(&value, 4); }
  MessageBytes& F64(double value) { return Number(&value, 8); }
  MessageBytes& Text(const std::string& text) {
    U32(static_cast<uint32_t>(text.size()) + (cdr_ ? 1 : 0));
    body_ += text;
    if (cdr_) body_ += '\0';
    return *this;
  }
  MessageBytes& Bytes(const std::string& bytes) {
    U32(static_cast<uint32_t>(bytes.size()));
    body_ += bytes;
    return *this;
  }
  MessageBytes& Header(int64_t stamp, const std::string& frame) {
    if (!cdr_) U32(7);
    U32(static_cast<uint32_t>(stamp / 1'000'000'000));
    U32(static_cast<uint32_t>(stamp % 1'000'000'000));
    return Text(frame);
  }
  std::string Done() const { return head_ + body_; }

 private:
  MessageBytes& Number(const void* value, size_t size) {
    if (cdr_) body_.resize((body_.size() + size - 1) / size * size);
    std::string bytes(size, '\0');
    std::memcpy(bytes.data(), value, size);
    if (big_endian_) bytes.assign(bytes.rbegin(), bytes.rend());
    body_ += bytes;
    return *this;
  }

  bool cdr_, big_endian_;
  std::string head_, body_;
};

struct Dialect {
  bool cdr = false;
  bool big_endian = false;
};

inline std::string BytesOf(const cv::Mat& image) {
  std::string bytes;
  for (int y = 0; y < image.rows; ++y)
    bytes.append(reinterpret_cast<const char*>(image.ptr(y)),
                 static_cast<size_t>(image.cols) * image.elemSize());
  return bytes;
}

// `rows`: rows of equal length in bytes.
inline std::string ImageMessage(Dialect dialect, int64_t stamp, const std::string& frame,
                                const std::string& encoding, cv::Size size,
                                const std::string& rows) {
  return MessageBytes(dialect.cdr, dialect.big_endian)
      .Header(stamp, frame)
      .U32(static_cast<uint32_t>(size.height))
      .U32(static_cast<uint32_t>(size.width))
      .Text(encoding)
      .U8(0)
      .U32(static_cast<uint32_t>(rows.size()) / static_cast<uint32_t>(size.height))
      .Bytes(rows)
      .Done();
}

inline std::string ImageMessage(Dialect dialect, int64_t stamp, const std::string& frame,
                                const std::string& encoding, const cv::Mat& image) {
  return ImageMessage(dialect, stamp, frame, encoding, image.size(), BytesOf(image));
}

inline std::string CompressedMessage(Dialect dialect, int64_t stamp, const std::string& frame,
                                     const std::string& format, const std::string& bytes) {
  return MessageBytes(dialect.cdr, dialect.big_endian)
      .Header(stamp, frame)
      .Text(format)
      .Bytes(bytes)
      .Done();
}

struct InfoFields {
  uint32_t width = 64, height = 48;
  std::string model = "plumb_bob", frame = "camera";
  std::vector<double> D = {0, 0, 0, 0, 0};
  std::array<double, 9> K = {60, 0, 31, 0, 61, 24, 0, 0, 1};
  std::array<double, 9> R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 12> P = {60, 0, 31, 0, 0, 61, 24, 0, 0, 0, 1, 0};
  uint32_t binning = 0;
};

inline std::string InfoMessage(Dialect dialect, int64_t stamp, const InfoFields& info) {
  MessageBytes bytes(dialect.cdr, dialect.big_endian);
  bytes.Header(stamp, info.frame).U32(info.height).U32(info.width).Text(info.model);
  bytes.U32(static_cast<uint32_t>(info.D.size()));
  for (const double d : info.D) bytes.F64(d);
  for (const double k : info.K) bytes.F64(k);
  for (const double r : info.R) bytes.F64(r);
  for (const double p : info.P) bytes.F64(p);
  bytes.U32(info.binning).U32(info.binning);
  return bytes.U32(0).U32(0).U32(0).U32(0).U8(0).Done();
}

}  // namespace alidade
