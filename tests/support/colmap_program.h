// Runs COLMAP, the real program, as an independent reader of exported models.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "support/program.h"
#include "support/rendered.h"

namespace alidade {

inline ProgramResult Colmap(const std::string& arguments) {
  const std::string command = "QT_QPA_PLATFORM=offscreen colmap " + arguments + " 2>&1";
  ProgramResult result;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  char buffer[4096];
  for (size_t got; (got = fread(buffer, 1, sizeof(buffer), pipe)) > 0;)
    result.out.append(buffer, got);
  result.status = pclose(pipe);
  return result;
}

inline bool HasColmap() { return Colmap("help").status == 0; }

// The number after `words`.
inline double NumberAfter(const std::string& text, const std::string& words) {
  const size_t at = text.find(words);
  if (at == std::string::npos) {
    ADD_FAILURE() << "no '" << words << "' in: " << text;
    return NAN;
  }
  return std::strtod(text.c_str() + at + words.size(), nullptr);
}

struct Triangulated {
  double points = 0, error = 0;  // mean reprojection error, pixels
};

// COLMAP extracts and matches its own features in the images of an exported folder and triangulates
// them with the exported poses and camera, which stay fixed.
inline Triangulated ColmapTriangulates(const std::string& folder, const std::string& database,
                                       const std::string& out) {
  std::istringstream camera(DataLines(folder + "/sparse/0/cameras.txt").at(0));
  std::string id, model, width, height, parameters, parameter;
  camera >> id >> model >> width >> height;
  while (camera >> parameter) parameters += (parameters.empty() ? "" : ",") + parameter;
  const auto run = [](const std::string& arguments) {
    const ProgramResult result = Colmap(arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.out;
  };
  const std::string in_database = " --database_path " + database;
  run("feature_extractor" + in_database + " --image_path " + folder +
      "/images --ImageReader.single_camera 1 --ImageReader.camera_model " + model +
      " --ImageReader.camera_params " + parameters +
      " --SiftExtraction.use_gpu 0 --SiftExtraction.max_num_features 1500");
  run("exhaustive_matcher" + in_database + " --SiftMatching.use_gpu 0");
  run("point_triangulator" + in_database + " --image_path " + folder + "/images --input_path " +
      folder + "/sparse/0 --output_path " + out + " --clear_points 1");
  const ProgramResult analysis = Colmap("model_analyzer --path " + out);
  return {NumberAfter(analysis.out, "\nPoints:"),
          NumberAfter(analysis.out, "\nMean reprojection error:")};
}

}  // namespace alidade
