// `alidade export`: writes a map to files for other programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "alidade/io/cloud.h"
#include "alidade/io/colmap.h"
#include "alidade/run/export/map_scale.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {

struct ExportSettings {
  // map: a map file; ply, pcd: the landmarks; tum, evo, kitti, euroc: a trajectory; colmap: both;
  // mcap: both, as ROS 2 messages; gsplat, nerfstudio, and colmap with images: folders to train on
  // (training_images.h)
  std::string to;
  std::string format = "default";  // text, binary, both (colmap, gsplat)
  int part = 0;                    // 0: the largest of the maps in the file
  // Landmarks observed by fewer keyframes are omitted. 0: 2 for folders of images, whose readers
  // (COLMAP's bundle adjuster) reject other points, else 1.
  int min_observations = 0;
  // Of folders of images:
  std::string images = "keyframes";  // FrameChoiceNamed()
  bool with_images = true;           // false: the sparse model alone (colmap)
  bool masks = false;                // of moving objects, where the run wrote them
  // Of trajectories: frames, keyframes, or default: frames of a result folder, but keyframes for
  // tum.
  std::string poses = "default";
  // Which way is up. map: as in the map; gravity: z (images and models: -y, as their readers
  // expect) is up by the map's gravity; z: by the mean upright axis of the camera (trajectories,
  // trajectory_export.h); default: gravity if the map knows it, but map for --to map and mcap.
  std::string up = "default";
  // Of ply and pcd: colors of the recording's images.
  bool colors = false;
  std::optional<KnownDistance> scale_by;      // of maps of one camera: lengths are then meters
  std::optional<std::string> source, camera;  // instead of those of the run

  bool WithImages() const;        // true if images are to be written
  bool IsTrajectory() const;      // of tum, evo, kitti and euroc
  int LeastObservations() const;  // min_observations with 0 resolved
  void Check() const;             // throws Error (usage) for unknown words
};

// The chosen map, with the landmarks that have enough observations. Throws Error (usage) for a part
// that does not exist.
MapPart PartFor(const SavedMap& saved, const ExportSettings& settings);

// Meters per map unit by scale_by; 1 without it. `path`: of the map or its result folder.
double ScaleFor(const std::string& path, const SavedMap& saved, const ExportSettings& settings);

// Rotation to the upright world by `up`; identity if it stays. Throws Error (usage) if `up` is
// gravity and the map does not know it.
Eigen::Matrix3d TurnFor(const SavedMap& saved, const ExportSettings& settings);

// "in meters, z up", for what was written; empty: nothing is known.
std::string WorldInWords(const SavedMap& saved, const ExportSettings& settings);

// The files of a COLMAP model in the form that --format names.
std::vector<ColmapFile> EncodeColmap(const ColmapModel& model, const ExportSettings& settings);

// Throws Error (input) if it cannot be written or is a folder.
void WriteExportFile(const std::string& path, const std::string& bytes);

// Writes a cloud as ply or pcd.
void WriteCloud(const Cloud& cloud, const ExportSettings& settings, const std::string& out);

// Writes `out`: a file, or for colmap a folder (export_folder.h) with the model alone. Returns a
// description of what was written ("3071 points"). Throws Error: usage for a part that does not
// exist and for formats that need images, input if writing fails.
std::string ExportMap(const SavedMap& saved, const ExportSettings& settings,
                      const std::string& out);

}  // namespace alidade
