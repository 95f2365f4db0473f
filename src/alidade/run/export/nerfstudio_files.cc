#include "alidade/run/export/nerfstudio_files.h"

#include <nlohmann/json.hpp>

namespace alidade {
namespace {

using nlohmann::ordered_json;

constexpr double kCornerToCenter = 0.5;  // pixels, of the top-left pixel

ordered_json Rows(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  ordered_json rows = ordered_json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({R(r, 0), R(r, 1), R(r, 2), t(r)});
  return rows;
}

}  // namespace

Eigen::Matrix3d NerfstudioFromMap() {
  return (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();
}

std::string NerfstudioJson(const ColmapModel& model, bool masks) {
  const Camera& camera = model.camera;
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  ordered_json json = {{"camera_model", "OPENCV"},
                       {"fl_x", camera.fx},
                       {"fl_y", camera.fy},
                       {"cx", camera.cx + kCornerToCenter},
                       {"cy", camera.cy + kCornerToCenter},
                       {"w", camera.width},
                       {"h", camera.height},
                       {"k1", k1},
                       {"k2", k2},
                       {"p1", p1},
                       {"p2", p2}};
  if (k3 != 0) json["k3"] = k3;
  json["applied_transform"] = Rows(NerfstudioFromMap(), Eigen::Vector3d::Zero());
  json["ply_file_path"] = "sparse_pc.ply";
  const Eigen::DiagonalMatrix<double, 3> opencv_from_opengl(1, -1, -1);
  ordered_json frames = ordered_json::array();
  for (const ColmapModel::Image& image : model.images) {
    const Se3 T_world_camera = image.T_camera_world.Inverse();
    ordered_json matrix = Rows(NerfstudioFromMap() * T_world_camera.R * opencv_from_opengl,
                               NerfstudioFromMap() * T_world_camera.t);
    matrix.push_back({0, 0, 0, 1});
    ordered_json frame = {{"file_path", "images/" + image.name}, {"transform_matrix", matrix}};
    if (masks) frame["mask_path"] = "masks/" + image.name + ".png";
    frames.push_back(std::move(frame));
  }
  json["frames"] = std::move(frames);
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Cloud NerfstudioCloud(const ColmapModel& model) {
  Cloud cloud;
  for (const ColmapModel::Point& point : model.points) {
    cloud.points.push_back((NerfstudioFromMap() * point.p_world).cast<float>());
    cloud.colors.push_back(point.color);
  }
  return cloud;
}

}  // namespace alidade
