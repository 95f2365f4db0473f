// Fields that calibrations of several tools share.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/calibration.h"
#include "alidade/io/files/yaml.h"

namespace alidade {

// fx fy cx cy. Refuses focal lengths that are not positive, and values beyond 1e9, at `at`.
void SetIntrinsics(const YamlFile& file, const YAML::Node& at, const std::string& key,
                   const std::array<double, 4>& intrinsics, RawCamera& camera);
// From a list [fx, fy, cx, cy].
void SetIntrinsics(const YamlFile& file, const YAML::Node& list, const std::string& key,
                   RawCamera& camera);
// From a 3x3 matrix as read by MatrixOf(). Refuses skew.
void SetMatrix(const YamlFile& file, const YAML::Node& at, const std::string& key,
               const std::vector<double>& K, RawCamera& camera);

void SetSize(const YamlFile& file, const YAML::Node& parent, const std::string& width_key,
             const std::string& height_key, RawCamera& camera);
// From a list [width, height].
void SetResolution(const YamlFile& file, const YAML::Node& list, const std::string& key,
                   RawCamera& camera);

// Distortion coefficients in OpenCV's order, by their number; adds to `told` what was approximated.
// Without a size the image is assumed to be centered on the principal point.
void SetOpenCvLens(const YamlFile& file, const YAML::Node& at, const std::string& key,
                   const std::vector<double>& coefficients, RawCamera& camera, std::string& told);
// k1 k2 k3 k4 of Kannala and Brandt's (equidistant) model; missing ones are 0.
void SetFisheyeLens(const YamlFile& file, const YAML::Node& at, const std::string& key,
                    const std::vector<double>& coefficients, RawCamera& camera);

// The numbers of a matrix or vector: a list, a list of rows, or {rows, cols, data}. `count` 0: any.
std::vector<double> MatrixOf(const YamlFile& file, const YAML::Node& node, const std::string& key,
                             size_t count);
// A 4x4 or 3x4 matrix in these forms.
Se3 TransformOf(const YamlFile& file, const YAML::Node& node, const std::string& key);

// Number, if there is one, otherwise `missing`.
double NumberOr(const YamlFile& file, const YAML::Node& parent, const std::string& key,
                double missing);
// A number that must be positive.
double PositiveNumber(const YamlFile& file, const YAML::Node& parent, const std::string& key);
// Frames per second, if stated.
void SetFps(const YamlFile& file, const YAML::Node& parent, const std::string& key,
            Calibration& calibration);

// Adds a sentence.
void Tell(std::string& told, const std::string& sentence);

}  // namespace alidade
