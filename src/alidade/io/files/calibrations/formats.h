// Calibrations of other tools, recognized by their content.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "alidade/io/calibration.h"
#include "alidade/io/files/yaml.h"

namespace alidade {

// One tool's YAML or JSON.
struct CalibrationFormat {
  const char* name;  // of the tool and file, in messages
  bool (*recognizes)(const YAML::Node& root);
  // `which`: the camera the user chose, by its name in the file; empty: none was chosen. Throws
  // Error (input). The image size may stay 0 when the file does not state it.
  Calibration (*reads)(const YamlFile& file, const std::string& which);
};

extern const CalibrationFormat kKalibrFormat;      // camchain
extern const CalibrationFormat kEurocFormat;       // sensor.yaml
extern const CalibrationFormat kRosFormat;         // camera_info.yaml
extern const CalibrationFormat kOpenCvFormat;      // cv::FileStorage
extern const CalibrationFormat kOrbSlamFormat;     // settings of ORB-SLAM 2 and 3
extern const CalibrationFormat kStellaFormat;      // stella_vslam and OpenVSLAM
extern const CalibrationFormat kNerfstudioFormat;  // transforms.json
extern const CalibrationFormat kRealSenseFormat;
extern const CalibrationFormat kOakFormat;  // DepthAI
extern const CalibrationFormat kBasaltFormat;

// COLMAP's cameras.txt, which is not YAML.
bool IsColmapCameras(std::string_view text);
Calibration ReadColmapCameras(std::string_view text, const std::string& name,
                              const std::string& which);

// What `rs-enumerate-devices -c` prints, which is not YAML either.
bool IsRealSenseListing(std::string_view text);
// The intrinsics of one stream of the listing as kRealSenseFormat reads them, each on its own line.
// `which`: "Color" or "Color/640x480"; a stream without a size is that of `images`. Throws Error
// (input) if that is not one.
std::string YamlOfListing(const std::string& text, const std::string& name,
                          const std::string& which, cv::Size images);

// Refuses the choice of a camera where the file has only one.
void RefuseChoice(const YamlFile& file, const std::string& which);

}  // namespace alidade
