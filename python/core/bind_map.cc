#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/map/depth_cloud.h"
#include "alidade/run/export/export_path.h"
#include "alidade/run/export/map_files.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/run/world/moved_map.h"
#include "arrays.h"
#include "map_value.h"
#include "values.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;

// One of the unconnected maps of a SavedMap; keeps the SavedMap alive.
struct Part {
  MapHolder saved;
  MapPart ids;

  const MapSnapshot& map() const { return saved->map; }
};

std::vector<Part> PartsWith(const MapHolder& saved) {
  std::vector<Part> parts;
  for (MapPart& ids : PartsOf(saved->map)) parts.push_back({saved, std::move(ids)});
  return parts;
}

py::dict KeyFramesOf(const Part& part) {
  std::vector<uint32_t> ids;
  std::vector<int64_t> parents;
  std::vector<int> numbers;
  std::vector<double> times, scales;
  std::vector<Se3> poses;
  for (KeyFrameId id : part.ids.keyframes) {
    const KeyFrame& keyframe = *part.map().Find(id);
    ids.push_back(id.value);
    parents.push_back(keyframe.parent.valid() ? int64_t{keyframe.parent.value} : -1);
    numbers.push_back(keyframe.frame->number);
    times.push_back(keyframe.frame->time);
    scales.push_back(keyframe.scale);
    poses.push_back(keyframe.T_camera_world.Inverse());
  }
  return py::dict("ids"_a = Table(ids), "parents"_a = Table(parents), "numbers"_a = Table(numbers),
                  "times"_a = Table(times), "scales"_a = Table(scales),
                  "poses"_a = PoseArray(poses));
}

py::dict PointsOf(const Part& part) {
  std::vector<uint32_t> ids;
  std::vector<double> positions;
  std::vector<float> normals, still;
  std::vector<int> seen;
  std::vector<uint64_t> descriptors;
  for (LandmarkId id : part.ids.landmarks) {
    const Landmark& landmark = *part.map().Find(id);
    ids.push_back(id.value);
    for (int i = 0; i < 3; ++i) {
      positions.push_back(landmark.p_world[i]);
      normals.push_back(landmark.normal[i]);
    }
    still.push_back(landmark.static_probability);
    seen.push_back(static_cast<int>(landmark.observations.size()));
  }
  return py::dict("ids"_a = Table(ids), "positions"_a = Table(positions, 3),
                  "normals"_a = Table(normals, 3), "static_probability"_a = Table(still),
                  "seen_by"_a = Table(seen));
}

py::dict ObservationsOf(const Part& part) {
  std::vector<uint32_t> keyframes, points;
  std::vector<float> pixels;
  for (LandmarkId id : part.ids.landmarks) {
    for (const Observation& seen : part.map().Find(id)->observations) {
      const KeyFrame* keyframe = part.map().Find(seen.keyframe);
      if (keyframe == nullptr) continue;
      const Keypoint& keypoint = keyframe->frame->keypoints[static_cast<size_t>(seen.keypoint)];
      keyframes.push_back(seen.keyframe.value);
      points.push_back(id.value);
      pixels.push_back(keypoint.raw_x);
      pixels.push_back(keypoint.raw_y);
    }
  }
  return py::dict("keyframes"_a = Table(keyframes), "points"_a = Table(points),
                  "pixels"_a = Table(pixels, 2));
}

// Each pair once, the smaller id first.
py::array_t<uint32_t> CovisibilityOf(const Part& part) {
  std::vector<uint32_t> rows;
  for (KeyFrameId id : part.ids.keyframes) {
    std::vector<Neighbour> neighbours = part.map().Find(id)->covisible;
    std::sort(neighbours.begin(), neighbours.end(),
              [](const Neighbour& a, const Neighbour& b) { return a.id.value < b.id.value; });
    for (const Neighbour& other : neighbours) {
      if (other.id.value > id.value)
        rows.insert(rows.end(), {id.value, other.id.value, static_cast<uint32_t>(other.shared)});
    }
  }
  return Table(rows, 3);
}

py::array_t<uint32_t> LoopsOf(const Part& part) {
  std::vector<uint32_t> rows;
  for (KeyFrameId id : part.ids.keyframes) {
    for (KeyFrameId other : part.map().Find(id)->loops) {
      if (other.value > id.value) rows.insert(rows.end(), {id.value, other.value});
    }
  }
  return Table(rows, 2);
}

py::dict CloudOf(const Part& part, double voxel) {
  if (!(voxel >= 0)) ThrowUsage("voxel must be a positive length, or 0 for one point per pixel");
  Cloud cloud;
  {
    const py::gil_scoped_release release;
    std::vector<PlacedDepth> placed;
    for (KeyFrameId id : part.ids.keyframes) {
      const KeyFrame& keyframe = *part.map().Find(id);
      if (keyframe.depth) placed.push_back(PlaceDepth(keyframe));
    }
    cloud = MakeDepthCloud(placed, part.saved->camera, voxel);
  }
  std::vector<float> points;
  std::vector<uint8_t> colors;
  for (const Eigen::Vector3f& p : cloud.points) points.insert(points.end(), {p.x(), p.y(), p.z()});
  for (const auto& rgb : cloud.colors) colors.insert(colors.end(), rgb.begin(), rgb.end());
  return py::dict("points"_a = Table(points, 3), "colors"_a = Table(colors, 3),
                  "sigmas"_a = Table(cloud.sigmas));
}

py::object DepthOf(const Part& part, uint32_t keyframe_id) {
  const KeyFrame* keyframe = part.map().Find(KeyFrameId{keyframe_id});
  if (keyframe == nullptr) ThrowUsage("the map has no keyframe " + std::to_string(keyframe_id));
  if (!keyframe->depth) return py::none();
  const PlacedDepth placed = PlaceDepth(*keyframe);
  const DepthMap& depth = *placed.depth;
  cv::Mat metres(depth.height, depth.width, CV_32F, cv::Scalar(0));
  cv::Mat sigma = metres.clone();
  for (const DepthPixel& pixel : depth.pixels) {
    const double z = placed.scale / pixel.inverse_depth;
    metres.at<float>(pixel.y, pixel.x) = static_cast<float>(z);
    sigma.at<float>(pixel.y, pixel.x) = static_cast<float>(z * pixel.sigma / pixel.inverse_depth);
  }
  return py::make_tuple(ArrayOf(metres), ArrayOf(sigma));
}

py::object GravityOf(const Part& part) {
  const MapWorld world = WorldOf(*part.saved, part.ids);
  if (!world.KnowsDown()) return py::none();
  return Table(std::vector<double>{world.down.x(), world.down.y(), world.down.z()});
}

// A standard deviation; 0: unknown.
py::object SigmaOf(double sigma) {
  return sigma > 0 ? py::object(py::float_(sigma)) : py::object(py::none());
}

MapHolder Read(const std::string& path) {
  const py::gil_scoped_release release;
  return std::make_shared<MapValue>(ReadSavedMap(path));
}

MapHolder Decode(const py::bytes& bytes) {
  const std::string_view view = bytes;
  const py::gil_scoped_release release;
  return std::make_shared<MapValue>(DecodeMap(view));
}

std::string Encode(const MapHolder& saved) {
  const py::gil_scoped_release release;
  return EncodeMap(*saved);
}

ExportSettings HowToExport(const std::string& to, const std::string& format, int part,
                           int min_observations) {
  ExportSettings settings;
  settings.to = to;
  settings.format = format;
  settings.part = part;
  settings.min_observations = min_observations;
  settings.Check();
  return settings;
}

py::str Export(const MapHolder& saved, const std::string& out, const std::string& to,
               const std::string& format, int part, int min_observations) {
  std::string told;
  {
    const py::gil_scoped_release release;
    ExportSettings settings = HowToExport(to, format, part, min_observations);
    if (to == "colmap") settings.with_images = false;  // a map has none
    told = ExportSaved(*saved, settings, out);
  }
  return PathText(told);
}

py::str ExportFrom(const std::string& path, const std::string& out, const std::string& to,
                   const std::string& format, int part, int min_observations,
                   const std::optional<std::string>& images, bool masks,
                   const std::optional<std::string>& source,
                   const std::optional<std::string>& camera) {
  std::string told;
  {
    const py::gil_scoped_release release;
    ExportSettings settings = HowToExport(to, format, part, min_observations);
    settings.with_images = images.has_value();
    if (images) settings.images = *images;
    settings.masks = masks;
    settings.source = source;
    settings.camera = camera;
    told = ExportPath(path, settings, out);
  }
  return PathText(told);
}

}  // namespace

void BindMap(py::module_& core) {
  py::class_<Part>(core, "MapPart")
      .def("keyframes", &KeyFramesOf)
      .def("points", &PointsOf)
      .def("observations", &ObservationsOf)
      .def("covisibility", &CovisibilityOf)
      .def("loops", &LoopsOf)
      .def("cloud", &CloudOf, py::arg("voxel"))
      .def("depth", &DepthOf, py::arg("keyframe"))
      .def_property_readonly("metric",
                             [](const Part& part) {
                               return InMeters(*part.saved, WorldOf(*part.saved, part.ids).map);
                             })
      .def_property_readonly(
          "scale_sigma",
          [](const Part& part) { return SigmaOf(WorldOf(*part.saved, part.ids).scale_sigma); })
      .def_property_readonly("gravity", &GravityOf)
      .def_property_readonly("gravity_sigma", [](const Part& part) {
        return SigmaOf(WorldOf(*part.saved, part.ids).down_sigma);
      });
  py::class_<MapValue, MapHolder>(core, "Map")
      .def_property_readonly("sensor", [](const MapValue& map) { return map.sensor; })
      .def_property_readonly("camera", [](const MapValue& map) { return CameraObject(map.camera); })
      .def_property_readonly("settings",
                             [](const MapValue& map) {
                               py::dict settings;
                               for (const auto& [name, value] : map.settings)
                                 settings[py::str(name)] = value;
                               return settings;
                             })
      .def_property_readonly("keyframe_count",
                             [](const MapValue& map) { return map.map.keyframe_count(); })
      .def_property_readonly("point_count",
                             [](const MapValue& map) { return map.map.landmark_count(); })
      .def("parts", &PartsWith)
      .def("encode", [](const MapHolder& map) { return py::bytes(Encode(map)); })
      .def("save",
           [](const MapHolder& map, const std::string& path) {
             const std::string bytes = Encode(map);
             const py::gil_scoped_release release;
             AtomicWriteFile(path, bytes);
           })
      .def("export", &Export, py::arg("path"), py::arg("to"), py::arg("format"), py::arg("part"),
           py::arg("min_observations"));
  core.def("read_map", &Read, py::arg("path"));
  core.def("decode_map", &Decode, py::arg("bytes"));
  core.def("export_path", &ExportFrom, py::arg("path"), py::arg("out"), py::arg("to"),
           py::arg("format"), py::arg("part"), py::arg("min_observations"), py::arg("images"),
           py::arg("masks"), py::arg("source"), py::arg("camera"));
}

}  // namespace alidade::python
