#include "alidade/io/colmap.h"

#include <locale>
#include <sstream>
#include <type_traits>
#include <utility>

#include "alidade/base/error.h"

namespace alidade {
namespace {

// COLMAP puts the pixel origin at the image corner, Alidade at the center of the first pixel.
constexpr double kHalfPixel = 0.5;

struct CameraModel {
  int32_t number;  // model id in binary files
  const char* name;
  std::vector<double> parameters;
};

CameraModel ModelOf(const RawCamera& camera) {
  std::vector<double> parameters = {camera.fx, camera.fy, camera.cx + kHalfPixel,
                                    camera.cy + kHalfPixel};
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const bool fisheye = camera.lens == Lens::kFisheye;
  if (!fisheye && camera.distortion == std::array<double, 5>{}) return {1, "PINHOLE", parameters};
  parameters.insert(parameters.end(), {k1, k2, p1, p2});
  if (fisheye) return {5, "OPENCV_FISHEYE", parameters};
  if (k3 == 0) return {4, "OPENCV", parameters};
  parameters.insert(parameters.end(), {k3, 0, 0, 0});  // k4 k5 k6 of the rational model
  return {6, "FULL_OPENCV", parameters};
}

RawCamera RawOf(const Camera& camera) {
  return {Lens::kPinhole, camera.width, camera.height, camera.fx,
          camera.fy,      camera.cx,    camera.cy,     camera.distortion};
}

void Check(const ColmapModel& model) {
  const auto within = [](int index, size_t size) {
    return index >= 0 && static_cast<size_t>(index) < size;
  };
  for (const ColmapModel::Image& image : model.images) {
    if (image.name.empty() || image.name.find_first_of(" \t\r\n") != std::string::npos) {
      ThrowUsage("a COLMAP image cannot be called '" + image.name + "'");
    }
    for (const ColmapModel::Keypoint& keypoint : image.keypoints) {
      if (keypoint.point != ColmapModel::kNoPoint && !within(keypoint.point, model.points.size())) {
        ThrowUsage("a COLMAP keypoint refers to a point that does not exist");
      }
    }
  }
  for (const ColmapModel::Point& point : model.points) {
    for (const ColmapModel::Seen& seen : point.track) {
      if (!within(seen.image, model.images.size()) ||
          !within(seen.keypoint, model.images[seen.image].keypoints.size())) {
        ThrowUsage("a COLMAP track refers to a keypoint that does not exist");
      }
    }
  }
}

std::ostringstream DoubleText() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);  // max_digits10 of double: reads back exactly
  return out;
}

std::string ImagesText(const ColmapModel& model) {
  std::ostringstream out = DoubleText();
  out << "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
         "# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (size_t i = 0; i < model.images.size(); ++i) {
    const ColmapModel::Image& image = model.images[i];
    const Eigen::Quaterniond q = image.T_camera_world.Quaternion();
    const Eigen::Vector3d& t = image.T_camera_world.t;
    out << i + 1;
    for (double value : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) out << ' ' << value;
    out << " 1 " << image.name << '\n';
    const char* gap = "";
    for (const ColmapModel::Keypoint& keypoint : image.keypoints) {
      out << gap << keypoint.pixel.x() + kHalfPixel << ' ' << keypoint.pixel.y() + kHalfPixel << ' '
          << (keypoint.point == ColmapModel::kNoPoint ? -1 : keypoint.point + 1);
      gap = " ";
    }
    out << '\n';
  }
  return out.str();
}

std::string PointsText(const ColmapModel& model) {
  std::ostringstream out = DoubleText();
  out << "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (size_t i = 0; i < model.points.size(); ++i) {
    const ColmapModel::Point& point = model.points[i];
    out << i + 1;
    for (double value : {point.p_world.x(), point.p_world.y(), point.p_world.z()}) {
      out << ' ' << value;
    }
    for (int channel : point.color) out << ' ' << channel;
    out << ' ' << point.error;
    for (const ColmapModel::Seen& seen : point.track) {
      out << ' ' << seen.image + 1 << ' ' << seen.keypoint;
    }
    out << '\n';
  }
  return out.str();
}

// Integers, doubles and strings in COLMAP's binary encoding: little endian, without padding.
class Bytes {
 public:
  template <typename Integer>
  void Add(Integer value) {
    static_assert(std::is_integral_v<Integer>);
    for (size_t byte = 0; byte < sizeof(value); ++byte) {
      bytes_.push_back(static_cast<char>((static_cast<uint64_t>(value) >> (8 * byte)) & 0xff));
    }
  }
  void Add(double value) { Add(Eigen::numext::bit_cast<uint64_t>(value)); }
  void Add(const std::string& text) { bytes_.append(text.c_str(), text.size() + 1); }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

std::string CamerasBinary(const ColmapModel& model) {
  Bytes out;
  const CameraModel camera = ModelOf(RawOf(model.camera));
  out.Add(uint64_t{1});  // number of cameras
  out.Add(uint32_t{1});  // camera id
  out.Add(camera.number);
  out.Add(static_cast<uint64_t>(model.camera.width));
  out.Add(static_cast<uint64_t>(model.camera.height));
  for (double parameter : camera.parameters) out.Add(parameter);
  return out.Take();
}

std::string ImagesBinary(const ColmapModel& model) {
  Bytes out;
  out.Add(uint64_t{model.images.size()});
  for (size_t i = 0; i < model.images.size(); ++i) {
    const ColmapModel::Image& image = model.images[i];
    const Eigen::Quaterniond q = image.T_camera_world.Quaternion();
    const Eigen::Vector3d& t = image.T_camera_world.t;
    out.Add(static_cast<uint32_t>(i + 1));
    for (double value : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) out.Add(value);
    out.Add(uint32_t{1});  // camera id
    out.Add(image.name);
    out.Add(uint64_t{image.keypoints.size()});
    for (const ColmapModel::Keypoint& keypoint : image.keypoints) {
      out.Add(keypoint.pixel.x() + kHalfPixel);
      out.Add(keypoint.pixel.y() + kHalfPixel);
      out.Add(keypoint.point == ColmapModel::kNoPoint ? ~uint64_t{0}
                                                      : static_cast<uint64_t>(keypoint.point) + 1);
    }
  }
  return out.Take();
}

std::string PointsBinary(const ColmapModel& model) {
  Bytes out;
  out.Add(uint64_t{model.points.size()});
  for (size_t i = 0; i < model.points.size(); ++i) {
    const ColmapModel::Point& point = model.points[i];
    out.Add(static_cast<uint64_t>(i + 1));
    for (double value : {point.p_world.x(), point.p_world.y(), point.p_world.z()}) out.Add(value);
    for (uint8_t channel : point.color) out.Add(channel);
    out.Add(point.error);
    out.Add(uint64_t{point.track.size()});
    for (const ColmapModel::Seen& seen : point.track) {
      out.Add(static_cast<uint32_t>(seen.image + 1));
      out.Add(static_cast<uint32_t>(seen.keypoint));
    }
  }
  return out.Take();
}

}  // namespace

std::string EncodeColmapCamera(const RawCamera& camera) {
  const CameraModel model = ModelOf(camera);
  std::ostringstream out = DoubleText();
  out << "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 " << model.name << ' ' << camera.width
      << ' ' << camera.height;
  for (double parameter : model.parameters) out << ' ' << parameter;
  out << '\n';
  return out.str();
}

std::vector<ColmapFile> EncodeColmapText(const ColmapModel& model) {
  Check(model);
  return {{"cameras.txt", EncodeColmapCamera(RawOf(model.camera))},
          {"images.txt", ImagesText(model)},
          {"points3D.txt", PointsText(model)}};
}

std::vector<ColmapFile> EncodeColmapBinary(const ColmapModel& model) {
  Check(model);
  return {{"cameras.bin", CamerasBinary(model)},
          {"images.bin", ImagesBinary(model)},
          {"points3D.bin", PointsBinary(model)}};
}

}  // namespace alidade
