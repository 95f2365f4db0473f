// A floor grid as a drawing: its cells, the camera's path over them, a scale bar.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace alidade {

struct GridDrawing {
  int width = 0, height = 0;  // cells
  double cell = 0;            // edge length, in `unit`
  double x = 0, y = 0;        // of the corner of the first cell, which is at the bottom left
  std::string png;            // of the cells, one pixel each, the top row first
  std::vector<Eigen::Vector2d> path;  // of the camera above the floor, in the grid's frame
  std::string unit;                   // of lengths, for example "m"
};

// SVG element of kPictureWidth with all cells and all of the path. Requires width and height > 0.
std::string DrawGrid(const GridDrawing& grid);

}  // namespace alidade
