// Encodes floor grids as map_server of ROS 1 and Nav2 reads them.
#include <locale>
#include <sstream>

#include "alidade/surface/occupancy.h"

namespace alidade {
namespace {

// Gray levels of map_saver. The server takes p = (255 - gray) / 255 as probability: 0 is 1, 254 is
// 0.004, and 205 is 0.1961, just above free_thresh.
constexpr char kOccupied = 0, kFree = static_cast<char>(254), kUnknown = static_cast<char>(205);

std::string Number(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  out << value;
  return out.str();
}

}  // namespace

std::string EncodeGridPgm(const OccupancyPicture& picture) {
  std::string pgm =
      "P5\n" + std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n255\n";
  for (int row = picture.height - 1; row >= 0; --row) {
    for (int column = 0; column < picture.width; ++column) {
      const int8_t cell = picture.At(column, row);
      pgm.push_back(cell < 0 ? kUnknown : cell >= 50 ? kOccupied : kFree);
    }
  }
  return pgm;
}

std::string EncodeGridYaml(const OccupancyPicture& picture, const std::string& image,
                           const std::vector<std::string>& notes) {
  std::string yaml;
  for (const std::string& note : notes) yaml += "# " + note + "\n";
  std::string name;
  for (const char c : image) name += c == '\'' ? "''" : std::string(1, c);
  yaml += "image: '" + name + "'\nmode: trinary\nresolution: " + Number(picture.cell) +
          "\norigin: [" + Number(picture.x) + ", " + Number(picture.y) +
          ", 0]\nnegate: 0\noccupied_thresh: 0.65\n"
          "# ROS 1's value. With Nav2's 0.25 unknown cells (gray 205, probability 0.1961) would be "
          "free.\nfree_thresh: 0.196\n";
  return yaml;
}

}  // namespace alidade
