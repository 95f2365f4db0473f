#include "alidade/io/ros/messages/foxglove_calibration.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/printable.h"
#include "alidade/io/ros/messages/message_cursor.h"
#include "alidade/io/ros/messages/protobuf_cursor.h"

namespace alidade {
namespace {

constexpr size_t kMostNumbers = 64;  // in one field; the longest lens has 14

// Adds the numbers of a field: all of them in a row, or a single one.
void AddDoubles(const ProtobufCursor::Field& field, std::vector<double>& numbers) {
  const std::string_view bytes = field.bytes;
  if (field.is_bytes) {
    for (size_t at = 0; at + 8 <= bytes.size() && numbers.size() <= kMostNumbers; at += 8) {
      uint64_t bits = 0;
      for (size_t i = 8; i-- > 0;) bits = bits << 8 | static_cast<uint8_t>(bytes[at + i]);
      numbers.push_back(std::bit_cast<double>(bits));
    }
  } else {
    numbers.push_back(std::bit_cast<double>(field.value));
  }
  if (numbers.size() > kMostNumbers) ThrowInput("has too many numbers in a field");
}

// A matrix that is not stated stays 0.
template <size_t N>
std::array<double, N> MatrixOf(const std::vector<double>& numbers, const char* name) {
  std::array<double, N> matrix{};
  if (numbers.empty()) return matrix;
  if (numbers.size() != N) {
    ThrowInput(std::string("has ") + std::to_string(numbers.size()) + " numbers in " + name + ": " +
               std::to_string(N) + " are needed");
  }
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  return matrix;
}

RosCameraInfo ParseProtobuf(std::string_view message) {
  ProtobufCursor cursor(message);
  RosCameraInfo info;
  std::vector<double> K, R, P;
  while (const auto field = cursor.Next()) {
    switch (field->number) {
      case 2:
        info.width = static_cast<uint32_t>(field->value);
        break;
      case 3:
        info.height = static_cast<uint32_t>(field->value);
        break;
      case 4:
        info.distortion_model = Printable(field->bytes);
        break;
      case 5:
        AddDoubles(*field, info.D);
        break;
      case 6:
        AddDoubles(*field, K);
        break;
      case 7:
        AddDoubles(*field, R);
        break;
      case 8:
        AddDoubles(*field, P);
        break;
      case 9:
        info.header.frame_id = field->bytes;
        break;
      default:
        break;
    }
  }
  info.K = MatrixOf<9>(K, "K");
  info.R = MatrixOf<9>(R, "R");
  info.P = MatrixOf<12>(P, "P");
  return info;
}

template <size_t N>
void Take(MessageCursor& cursor, std::array<double, N>& matrix) {
  for (double& value : matrix) value = cursor.Double();
}

RosCameraInfo ParseRos(std::string_view message, Serialization serialization) {
  MessageCursor cursor(message, serialization);
  RosCameraInfo info;
  cursor.Uint32();  // time, seconds
  cursor.Uint32();  // nanoseconds
  info.header.frame_id = cursor.Text();
  info.width = cursor.Uint32();
  info.height = cursor.Uint32();
  info.distortion_model = Printable(cursor.Text());
  const uint32_t coefficients = cursor.Uint32();
  if (coefficients > kMostNumbers) ThrowInput("has too many distortion coefficients");
  for (uint32_t i = 0; i < coefficients; ++i) info.D.push_back(cursor.Double());
  Take(cursor, info.K);
  Take(cursor, info.R);
  Take(cursor, info.P);
  return info;
}

}  // namespace

RosCameraInfo ParseFoxgloveCalibration(std::string_view message, Serialization serialization) {
  RosCameraInfo info = serialization == Serialization::kProtobuf ? ParseProtobuf(message)
                                                                 : ParseRos(message, serialization);
  if (info.distortion_model == "kannala_brandt") info.distortion_model = "equidistant";
  // Writers that know one camera leave these out.
  if (std::all_of(info.R.begin(), info.R.end(), [](double r) { return r == 0; }))
    info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (std::all_of(info.P.begin(), info.P.end(), [](double p) { return p == 0; }))
    info.P = {info.K[0], info.K[1], info.K[2], 0,         info.K[3], info.K[4],
              info.K[5], 0,         info.K[6], info.K[7], info.K[8], 0};
  return info;
}

}  // namespace alidade
