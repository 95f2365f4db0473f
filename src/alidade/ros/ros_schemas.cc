#include "alidade/ros/ros_schemas.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace alidade {
namespace {

struct Definition {
  std::string_view name, fields;
};

// Fields and constants as defined by ROS 2 (Humble to Jazzy); types of fields are written with
// their package.
constexpr Definition kDefinitions[] = {
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    {"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    {"sensor_msgs/PointCloud2",
     "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
     "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    {"sensor_msgs/CameraInfo",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
     "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
     "sensor_msgs/RegionOfInterest roi\n"},
    {"diagnostic_msgs/DiagnosticArray",
     "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n"},
    {"rcl_interfaces/Log",
     "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n"
     "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
     "string function\nuint32 line\n"},
    {"nav_msgs/Odometry",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
     "geometry_msgs/TwistWithCovariance twist\n"},
    {"geometry_msgs/PoseWithCovarianceStamped",
     "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n"},
    {"nav_msgs/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n"},
    // types of the fields above
    {"nav_msgs/MapMetaData",
     "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
     "geometry_msgs/Pose origin\n"},
    {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"},
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    {"geometry_msgs/Transform",
     "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    {"sensor_msgs/PointField",
     "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
     "uint8 FLOAT32=7\nuint8 FLOAT64=8\n"
     "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    {"sensor_msgs/RegionOfInterest",
     "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    {"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    {"diagnostic_msgs/DiagnosticStatus",
     "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
     "byte level\nstring name\nstring message\nstring hardware_id\n"
     "diagnostic_msgs/KeyValue[] values\n"}};

const Definition& DefinitionOf(std::string_view name) {
  return *std::find_if(std::begin(kDefinitions), std::end(kDefinitions),
                       [&](const Definition& d) { return d.name == name; });
}

// Appends the definitions used as field types, recursively.
void AddParts(const Definition& whole, std::vector<std::string_view>& parts) {
  std::string_view rest = whole.fields;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(line.size() + 1);
    const std::string_view type = line.substr(0, line.find_first_of(" ["));
    if (type.find('/') == std::string_view::npos) continue;
    if (std::find(parts.begin(), parts.end(), type) != parts.end()) continue;
    parts.push_back(type);
    AddParts(DefinitionOf(type), parts);
  }
}

}  // namespace

std::string ShortNameOf(RosType type) {
  return std::string(kDefinitions[static_cast<size_t>(type)].name);
}

std::string NameOf(RosType type) {
  std::string name = ShortNameOf(type);
  return name.insert(name.find('/'), "/msg");
}

std::string SchemaOf(RosType type) {
  const Definition& whole = kDefinitions[static_cast<size_t>(type)];
  std::vector<std::string_view> parts;
  AddParts(whole, parts);
  std::string schema(whole.fields);
  for (const std::string_view part : parts) {
    schema += std::string(80, '=') + "\nMSG: ";
    schema += part;
    schema += "\n";
    schema += DefinitionOf(part).fields;
  }
  return schema;
}

}  // namespace alidade
