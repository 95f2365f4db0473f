// COLMAP's cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[] (colmap.github.io/cameras.html). The
// pixel origin is the image's corner: half a pixel is subtracted.
#include <algorithm>
#include <cmath>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/calibrations/fields.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/calibrations/lens_fit.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

struct ColmapLens {
  const char* name;
  int focals;  // 1: f, 2: fx fy
  // Names of the coefficients that follow cx cy.
  int coefficients;
  Lens lens;
};

constexpr ColmapLens kColmapLenses[] = {
    {"SIMPLE_PINHOLE", 1, 0, Lens::kPinhole}, {"PINHOLE", 2, 0, Lens::kPinhole},
    {"SIMPLE_RADIAL", 1, 1, Lens::kPinhole},  {"RADIAL", 1, 2, Lens::kPinhole},
    {"OPENCV", 2, 4, Lens::kPinhole},         {"FULL_OPENCV", 2, 8, Lens::kPinhole},
    {"OPENCV_FISHEYE", 2, 4, Lens::kFisheye}, {"SIMPLE_RADIAL_FISHEYE", 1, 1, Lens::kFisheye},
    {"RADIAL_FISHEYE", 1, 2, Lens::kFisheye}};

constexpr char kKnown[] =
    "SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, SIMPLE_RADIAL_FISHEYE, "
    "RADIAL_FISHEYE and OPENCV_FISHEYE";

bool IsWord(std::string_view text) {
  return text.size() >= 3 &&
         text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") ==
             std::string_view::npos &&
         std::isalpha(static_cast<unsigned char>(text[0])) != 0;
}

bool IsNumber(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

class Line {
 public:
  Line(const TextLine& line, const std::string& file)
      : fields_(Fields(line.text)), at_(file + ":" + std::to_string(line.number)) {}

  [[noreturn]] void Fail(const std::string& what) const {
    ThrowInput(at_ + ": COLMAP cameras.txt: " + what);
  }
  size_t size() const { return fields_.size(); }
  std::string Text(size_t i) const { return std::string(fields_[i].substr(0, 40)); }
  double Number(size_t i) const {
    const auto number = ParseNumber(fields_[i]);
    if (!number || !(std::abs(*number) <= 1e9)) Fail("`" + Text(i) + "` is not a number below 1e9");
    return *number;
  }
  int Side(size_t i) const {
    const double number = Number(i);
    if (!(number >= 1 && number <= 100000) || number != std::floor(number))
      Fail("WIDTH and HEIGHT must be whole numbers from 1 to 100000, not `" + Text(i) + "`");
    return static_cast<int>(number);
  }

 private:
  std::vector<std::string_view> fields_;
  std::string at_;
};

RawCamera ReadLine(const Line& line, std::string& told) {
  if (line.size() < 4) line.Fail("expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]");
  const std::string model = line.Text(1);
  const auto* lens = std::find_if(std::begin(kColmapLenses), std::end(kColmapLenses),
                                  [&](const ColmapLens& known) { return model == known.name; });
  if (lens == std::end(kColmapLenses)) {
    line.Fail("the MODEL `" + model + "` is not supported; supported are " + kKnown +
              ": undistort the images (colmap image_undistorter) or choose one of these with "
              "--ImageReader.camera_model");
  }
  const size_t count = static_cast<size_t>(lens->focals + 2 + lens->coefficients);
  if (line.size() != 4 + count) {
    line.Fail(model + " has " + std::to_string(count) + " parameters, not " +
              std::to_string(line.size() - 4));
  }
  RawCamera camera;
  camera.width = line.Side(2);
  camera.height = line.Side(3);
  if (!IsPictureSize(camera.width, camera.height))
    line.Fail(TooLargeText(camera.width, camera.height));
  size_t next = 4;
  camera.fx = line.Number(next++);
  camera.fy = lens->focals == 2 ? line.Number(next++) : camera.fx;
  if (!(camera.fx >= 1e-9 && camera.fy >= 1e-9)) line.Fail("focal lengths must be positive");
  camera.cx = line.Number(next++) - 0.5;
  camera.cy = line.Number(next++) - 0.5;
  std::vector<double> k;
  while (next < line.size()) k.push_back(line.Number(next++));
  if (lens->lens == Lens::kFisheye) {
    camera.lens = Lens::kFisheye;
    std::copy(k.begin(), k.end(), camera.distortion.begin());
    return camera;
  }
  try {
    Tell(told, SetOpenCvLens(k, camera));
  } catch (const Error& error) {
    line.Fail(error.what());
  }
  return camera;
}

}  // namespace

bool IsColmapCameras(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (begin == std::string_view::npos || (text[begin] != '#' && !IsNumber(text.substr(begin, 1))))
    return false;
  for (const TextLine& line : ContentLines(text)) {
    const auto fields = Fields(line.text);
    return fields.size() >= 2 && IsNumber(fields[0]) && IsWord(fields[1]);
  }
  return text.find("CAMERA_ID, MODEL, WIDTH, HEIGHT") != std::string_view::npos;
}

Calibration ReadColmapCameras(std::string_view text, const std::string& name,
                              const std::string& which) {
  Calibration calibration;
  std::string ids;
  int cameras = 0;
  std::optional<Line> chosen;
  for (const TextLine& text_line : ContentLines(text)) {
    const Line line(text_line, name);
    ++cameras;
    if (cameras <= 20) ids += (ids.empty() ? "" : ", ") + line.Text(0);
    if (which.empty() ? cameras == 1 : line.Text(0) == which) chosen = line;
  }
  if (cameras > 20) ids += ", …";
  if (cameras == 0) ThrowInput(name + ": COLMAP cameras.txt: has no camera");
  if (!chosen) {
    ThrowInput(name + ": COLMAP cameras.txt: there is no CAMERA_ID `" + which + "`, only " + ids);
  }
  if (which.empty() && cameras > 1) {
    ThrowInput(name + ": COLMAP cameras.txt: has " + std::to_string(cameras) +
               " cameras: choose one by its CAMERA_ID (" + ids + "), for instance --camera " +
               name + "#" + ids.substr(0, ids.find(',')));
  }
  calibration.left = ReadLine(*chosen, calibration.told);
  return calibration;
}

}  // namespace alidade
