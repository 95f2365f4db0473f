// Camera models with one center and rotational symmetry that Alidade approximates by its own.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/files/calibrations/fields.h"

namespace alidade {

// Sets the camera from the parameters of a model that Kalibr and Basalt call
//   ds    double sphere (Usenko, Demmel & Cremers 2018)
//   eucm  extended unified camera model (Khomutenko, Garcia & Martinet 2016)
//   ucm   unified camera model: alpha
//   omni  Mei & Rives 2007 without distortion: xi
//   fov   Devernay & Faugeras 2001: w
// by least squares, and says so in `told`. `parameters`: fx fy cx cy, then xi alpha of ds, alpha
// beta of eucm, and the single one of the others. Refuses other models by name at `model`, with
// `advice`.
void SetRadialModel(const YamlFile& file, const YAML::Node& model, const std::string& model_key,
                    const std::string& name, const YAML::Node& at, const std::string& key,
                    std::vector<double> parameters, const std::string& advice, RawCamera& camera,
                    std::string& told);

}  // namespace alidade
