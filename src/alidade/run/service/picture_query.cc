#include "alidade/run/service/picture_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/files/media.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr char kLensHelp[] =
    "tell the lens: ?f=PIXELS, ?fov=DEGREES (horizontal), ?fx=…&fy=…&cx=…&cy=… or ?camera=map";
constexpr size_t kMostNames = 64;
constexpr std::array<const char*, 15> kNames = {"camera", "cx", "cy",     "f",  "fov",
                                                "fx",     "fy", "height", "k1", "k2",
                                                "k3",     "k4", "model",  "p1", "p2"};

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Of application/x-www-form-urlencoded.
std::string Unescaped(std::string_view text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? HexDigit(text[i + 1]) : -1;
    const int low = high >= 0 ? HexDigit(text[i + 2]) : -1;
    if (low < 0) ThrowInput("the query has an invalid % escape");
    plain += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return plain;
}

// The numbers of a query.
class Numbers {
 public:
  explicit Numbers(const std::map<std::string, std::string>& query) : query_(query) {}

  std::optional<double> Find(const std::string& name) const {
    const auto found = query_.find(name);
    if (found == query_.end()) return std::nullopt;
    const std::optional<double> number = ParseNumber(found->second);
    if (!number || !std::isfinite(*number)) ThrowInput(name + " must be a number");
    return number;
  }
  std::optional<double> Positive(const std::string& name) const {
    const std::optional<double> number = Find(name);
    if (number && !(*number > 0)) ThrowInput(name + " must be positive");
    return number;
  }
  int Side(const std::string& name, int usual) const {
    const std::optional<double> number = Positive(name);
    if (!number) return usual;
    if (*number > kMostSide || *number != std::floor(*number))
      ThrowInput(name + " must be a whole number of pixels");
    return static_cast<int>(*number);
  }
  bool Has(const std::string& name) const { return query_.count(name) > 0; }

 private:
  const std::map<std::string, std::string>& query_;
};

Calibration Intrinsics(const Numbers& numbers, bool fisheye, cv::Size size) {
  RawCamera camera;
  camera.lens = fisheye ? Lens::kFisheye : Lens::kPinhole;
  camera.width = numbers.Side("width", size.width);
  camera.height = numbers.Side("height", size.height);
  const std::optional<double> f = numbers.Positive("f");
  const std::optional<double> fx = f ? f : numbers.Positive("fx");
  if (!fx) ThrowInput(kLensHelp);
  camera.fx = *fx;
  camera.fy = numbers.Positive("fy").value_or(*fx);
  camera.cx = numbers.Find("cx").value_or((camera.width - 1) / 2.0);
  camera.cy = numbers.Find("cy").value_or((camera.height - 1) / 2.0);
  const std::array<const char*, 5> names =
      fisheye ? std::array{"k1", "k2", "k3", "k4", ""} : std::array{"k1", "k2", "p1", "p2", "k3"};
  for (size_t i = 0; i < names.size(); ++i)
    camera.distortion[i] = numbers.Find(names[i]).value_or(0);
  Calibration calibration;
  calibration.left = camera;
  return calibration;
}

Calibration OfPhoto(cv::Size size, std::string_view bytes) {
  const double millimetres = FocalLength35OfImage(bytes);
  if (!(millimetres > 0))
    ThrowInput(std::string("the picture does not tell its focal length (EXIF); ") + kLensHelp);
  return GuessedCalibration(size.width, size.height, FovOfFocalLength35(millimetres, size));
}

void RefuseUnknown(const std::map<std::string, std::string>& query) {
  for (const auto& [name, value] : query) {
    if (name == "token" || name == "width") continue;
    if (std::none_of(kNames.begin(), kNames.end(),
                     [&known = name](const char* one) { return known == one; }))
      ThrowInput("the query has an unknown name; " + std::string(kLensHelp));
  }
}

}  // namespace

std::map<std::string, std::string> QueryOf(std::string_view query) {
  std::map<std::string, std::string> names;
  while (!query.empty()) {
    const size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (part.empty()) continue;
    const size_t equal = std::min(part.find('='), part.size());
    const std::string_view value = part.substr(std::min(equal + 1, part.size()));
    if (!names.emplace(Unescaped(part.substr(0, equal)), Unescaped(value)).second)
      ThrowInput("the query gives a name twice");
    if (names.size() > kMostNames) ThrowInput("the query has too many names");
  }
  return names;
}

double TakeProbability(std::map<std::string, std::string>& query) {
  const double least = Numbers(query).Positive("probability").value_or(0);
  if (least >= 1) ThrowInput("probability must be below 1");
  query.erase("probability");
  return least;
}

Calibration CalibrationOfQuery(const std::map<std::string, std::string>& query, cv::Size size,
                               std::string_view bytes, const Camera& map) {
  RefuseUnknown(query);
  const Numbers numbers(query);
  const auto text = [&](const char* name) {
    const auto found = query.find(name);
    return found == query.end() ? std::string() : found->second;
  };
  if (numbers.Has("camera") && text("camera") != "map") ThrowInput("camera must be map");
  if (numbers.Has("model") && text("model") != "pinhole" && text("model") != "fisheye")
    ThrowInput("model must be pinhole or fisheye");
  const int ways = numbers.Has("camera") + numbers.Has("fov") + numbers.Has("f") +
                   (numbers.Has("fx") || numbers.Has("fy"));
  if (ways > 1) ThrowInput("the lens is told twice; " + std::string(kLensHelp));
  if (ways == 0 && !query.empty() && !(query.size() == 1 && numbers.Has("token")))
    ThrowInput(kLensHelp);
  Calibration calibration;
  if (numbers.Has("camera")) {
    calibration = CalibrationOf(map);
    calibration.baseline = 0;
  } else if (const std::optional<double> fov = numbers.Positive("fov")) {
    if (*fov >= 180) ThrowInput("fov must be below 180 degrees");
    calibration = GuessedCalibration(size.width, size.height, *fov);
  } else if (ways == 0) {
    calibration = OfPhoto(size, bytes);
  } else {
    calibration = Intrinsics(numbers, text("model") == "fisheye", size);
  }
  calibration.origin = "the request";
  return FitToSize(std::move(calibration), size, false);
}

}  // namespace alidade
