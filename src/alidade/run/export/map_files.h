// `alidade export`: writes a map to files for other programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/colmap.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct ExportSettings {
  // ply, pcd: the landmarks; tum: the keyframes; colmap: both; mcap: both, as ROS 2 messages;
  // gsplat, nerfstudio, and colmap with images: folders to train on (training_images.h)
  std::string to;
  std::string format = "default";  // text, binary, both (colmap, gsplat)
  int part = 0;                    // 0: the largest of the maps in the file
  // Landmarks observed by fewer keyframes are omitted. 0: 2 for folders of images, whose readers
  // (COLMAP's bundle adjuster) reject other points, else 1.
  int min_observations = 0;
  // Of folders of images:
  std::string images = "keyframes";           // FrameChoiceNamed()
  bool with_images = true;                    // false: the sparse model alone (colmap)
  bool masks = false;                         // of moving objects, where the run wrote them
  std::optional<std::string> source, camera;  // instead of those of the run

  bool WithImages() const;  // true if images are to be written
  void Check() const;       // throws Error (usage) for unknown words
};

// The chosen map, with the landmarks that have enough observations. Throws Error (usage) for a part
// that does not exist.
MapPart PartFor(const SavedMap& saved, const ExportSettings& settings);

// The files of a COLMAP model in the form that --format names.
std::vector<ColmapFile> EncodeColmap(const ColmapModel& model, const ExportSettings& settings);

// Writes `out`: a file, or for colmap a folder (export_folder.h) with the model alone. Returns a
// description of what was written ("3071 points"). Throws Error: usage for a part that does not
// exist and for formats that need images, input if writing fails.
std::string ExportMap(const SavedMap& saved, const ExportSettings& settings,
                      const std::string& out);

}  // namespace alidade
