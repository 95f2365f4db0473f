#include "alidade/run/surface/surface_report.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/view/grid_drawing.h"
#include "alidade/view/page.h"
#include "alidade/view/report.h"
#include "alidade/view/svg.h"
#include "alidade/view/turnable.h"

namespace alidade {
namespace {

constexpr int kMeshJpegQuality = 88;  // as of the report's other clouds

// A folder without a report, as a merged one, stays without.
void PutSection(const std::string& folder, const std::string& name, const std::string& html) {
  const std::string path = (std::filesystem::path(folder) / "report.html").string();
  if (!IsFile(path)) return;
  const std::string page = ReadFile(path), changed = WithSection(page, name, html);
  if (changed != page) AtomicWriteFile(path, changed);
}

const char* UnitIn(const ViewWorld& world) { return world.meters ? "m" : "map units"; }

// Cells as in map.pgm.
std::string PngOf(const OccupancyPicture& picture) {
  cv::Mat1b gray(picture.height, picture.width);
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const int8_t state = picture.At(column, picture.height - 1 - row);
      gray(row, column) = state == 0 ? 254 : state > 0 ? 0 : 205;
    }
  }
  return EncodePng(gray);
}

}  // namespace

void ShowInReport(const std::string& folder, const GridResult& grid, const std::string& words) {
  const OccupancyPicture& picture = grid.picture;
  GridDrawing drawing{picture.width, picture.height, picture.cell, picture.x,
                      picture.y,     PngOf(picture), {},           UnitIn(grid.views.world)};
  for (const Se3& T : grid.views.world.path)
    drawing.path.push_back((grid.T_grid_world * T.t).head<2>());
  PutSection(
      folder, "grid",
      "<h2>Floor grid</h2>\n<div class=\"framed\">" + DrawGrid(drawing) + "</div>\n" +
          "<p class=\"soft\">White: free; black: occupied; gray: unknown. Blue: the camera's "
          "path, from the green dot to the red one. Files: map.yaml, map.pgm.</p>\n<p "
          "class=\"soft\">" +
          EscapeHtml(words) + "</p>\n");
}

void ShowInReport(const std::string& folder, const MeshResult& mesh, const std::string& words) {
  const ViewWorld& world = mesh.views.world;
  CloudScene scene{mesh.mesh.vertices, {world.path}};
  if (world.up) scene.gravity = -*world.up;
  const cv::Mat drawn = DrawCloud(scene, CloudView::kBehind);
  const ReportPicture picture{"the mesh from behind the first camera", "image/jpeg",
                              EncodeJpeg(drawn, kMeshJpegQuality)};
  PutSection(folder, "mesh",
             "<h2>Mesh</h2>\n" + TurnableHtml(scene, picture, UnitIn(world)) +
                 "<p class=\"soft\">Vertices of the mesh. Files: mesh.ply, mesh.glb.</p>\n<p "
                 "class=\"soft\">" +
                 EscapeHtml(words) + "</p>\n");
}

}  // namespace alidade
