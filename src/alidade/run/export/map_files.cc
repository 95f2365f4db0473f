#include "alidade/run/export/map_files.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "alidade/base/choice.h"
#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/export/export_folder.h"
#include "alidade/run/export/frame_choice.h"
#include "alidade/run/export/map_models.h"
#include "alidade/run/export/mcap_export.h"
#include "alidade/run/export/own_recording.h"
#include "alidade/run/export/posed_frames.h"
#include "alidade/run/export/trajectory_export.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/run/world/trajectory_file_for.h"
#include "alidade/version.h"

namespace alidade {
namespace {

enum class Target {
  kMap,
  kPly,
  kPcd,
  kTum,
  kEvo,
  kKitti,
  kEuroc,
  kColmap,
  kGsplat,
  kNerfstudio,
  kMcap
};
enum class Form { kDefault, kText, kBinary, kBoth };

struct Plan {
  Target target;
  Form form;
};

bool IsTrajectoryTarget(Target target) {
  return target == Target::kTum || target == Target::kEvo || target == Target::kKitti ||
         target == Target::kEuroc;
}

// Folders that may have images.
bool IsFolderTarget(Target target) {
  return target == Target::kColmap || target == Target::kGsplat || target == Target::kNerfstudio;
}

// The format with `default` resolved.
Plan PlanOf(const ExportSettings& settings) {
  const auto target = Choice<Target>("--to", settings.to,
                                     {{"map", Target::kMap},
                                      {"ply", Target::kPly},
                                      {"pcd", Target::kPcd},
                                      {"tum", Target::kTum},
                                      {"evo", Target::kEvo},
                                      {"kitti", Target::kKitti},
                                      {"euroc", Target::kEuroc},
                                      {"colmap", Target::kColmap},
                                      {"gsplat", Target::kGsplat},
                                      {"nerfstudio", Target::kNerfstudio},
                                      {"mcap", Target::kMcap}});
  auto form = Choice<Form>("--format", settings.format,
                           {{"text", Form::kText},
                            {"binary", Form::kBinary},
                            {"both", Form::kBoth},
                            {"default", Form::kDefault}});
  const bool trajectory = IsTrajectoryTarget(target);
  if (trajectory && form != Form::kDefault && form != Form::kText)
    ThrowUsage("--format cannot be '" + settings.format + "': trajectories are text");
  Choice<bool>("--poses", settings.poses,
               {{"default", true}, {"frames", true}, {"keyframes", true}});
  Choice<bool>("--up", settings.up,
               {{"default", true}, {"map", true}, {"gravity", true}, {"z", true}});
  if (!trajectory && settings.poses != "default")
    ThrowUsage("--poses is for --to tum, evo, kitti and euroc");
  if (!trajectory && settings.up == "z") ThrowUsage("--up z is for --to tum, evo, kitti and euroc");
  if (settings.up == "gravity" && (target == Target::kMap || target == Target::kMcap))
    ThrowUsage("--up gravity is not for --to map and mcap, which keep the world of the map");
  const bool model = target == Target::kColmap || target == Target::kGsplat;
  if (!model && form == Form::kBoth) {
    ThrowUsage("--format both is for --to colmap, whose model is a folder");
  }
  if (target == Target::kNerfstudio && form == Form::kText)
    ThrowUsage("--format cannot be 'text': the points of a nerfstudio folder are binary");
  if (target == Target::kMcap && form != Form::kDefault && form != Form::kBinary) {
    ThrowUsage("--format cannot be '" + settings.format + "': MCAP is binary");
  }
  if (form == Form::kDefault) form = model ? Form::kBoth : Form::kBinary;
  const bool images = IsFolderTarget(target);
  const bool cloud = target == Target::kPly || target == Target::kPcd;
  if (settings.colors && !cloud)
    ThrowUsage("--colors is for --to ply and pcd; images come with colored points");
  const bool about_images =
      settings.masks || settings.images != "keyframes" || !settings.with_images;
  if (!images && about_images)
    ThrowUsage("--images, --no-images and --masks are for --to colmap, gsplat and nerfstudio");
  const bool about_source = settings.source || settings.camera;
  if (!images && about_source && !settings.colors) {
    ThrowUsage(
        "--source and --camera are for --to colmap, gsplat and nerfstudio, and for ply and pcd "
        "with --colors");
  }
  if (!settings.with_images) {
    if (target != Target::kColmap)
      ThrowUsage("--no-images is for --to colmap: other trainers need the images");
    if (about_source || settings.masks || settings.images != "keyframes")
      ThrowUsage("--no-images cannot be combined with --images, --masks, --source and --camera");
  }
  if (target == Target::kMap && form == Form::kText)
    ThrowUsage("--format cannot be 'text': map files are binary");
  FrameChoiceNamed(settings.images);
  return {target, form};
}

MapPart PartOf(const SavedMap& saved, int number) {
  const std::vector<MapPart> parts = PartsOf(saved.map);
  if (parts.empty() && number == 0) return {};
  if (number < 0 || static_cast<size_t>(number) >= parts.size()) {
    ThrowUsage("--part " + std::to_string(number) +
               " does not exist: maps are numbered from 0, and their number is " +
               std::to_string(parts.size()));
  }
  return parts[static_cast<size_t>(number)];
}

}  // namespace

void ExportSettings::Check() const { PlanOf(*this); }

bool ExportSettings::IsTrajectory() const { return IsTrajectoryTarget(PlanOf(*this).target); }

bool ExportSettings::WithImages() const {
  return with_images && IsFolderTarget(PlanOf(*this).target);
}

int ExportSettings::LeastObservations() const {
  if (min_observations > 0) return min_observations;
  return IsFolderTarget(PlanOf(*this).target) ? 2 : 1;
}

MapPart PartFor(const SavedMap& saved, const ExportSettings& settings) {
  return SeenOften(saved, PartOf(saved, settings.part), settings.LeastObservations());
}

double ScaleFor(const std::string& path, const SavedMap& saved, const ExportSettings& settings) {
  if (!settings.scale_by) return 1;
  const MapPart part = PartOf(saved, settings.part);
  const std::string file = TrajectoryFileFor(saved, part, ResultFolderOf(path));
  return MetersPerUnit(saved, part, file.empty() ? Trajectory{} : ReadTrajectory(file),
                       *settings.scale_by);
}

Eigen::Matrix3d TurnFor(const SavedMap& saved, const ExportSettings& settings) {
  const Target target = PlanOf(settings).target;
  const bool keeps = target == Target::kMap || target == Target::kMcap;
  const bool asked = settings.up == "gravity";
  if (keeps || (settings.up != "default" && !asked)) return Eigen::Matrix3d::Identity();
  const MapWorld world = WorldOf(saved, PartOf(saved, settings.part));
  if (world.KnowsDown()) return Upright(world.down, /*y_down=*/IsFolderTarget(target));
  if (asked) {
    ThrowUsage(
        "--up gravity: the map does not know gravity. It does after a run with the readings of an "
        "inertial sensor (--imu), and after `alidade georeference`");
  }
  return Eigen::Matrix3d::Identity();
}

std::string WorldInWords(const SavedMap& saved, const ExportSettings& settings) {
  const Target target = PlanOf(settings).target;
  const MapWorld world = WorldOf(saved, PartOf(saved, settings.part));
  std::string words = settings.scale_by || InMeters(saved, world.map) ? "in meters" : "";
  const bool keeps = target == Target::kMap || target == Target::kMcap;
  const bool by_gravity = settings.up == "default" || settings.up == "gravity";
  if (!keeps && (settings.up == "z" || (by_gravity && world.KnowsDown())))
    words += std::string(words.empty() ? "" : ", ") +
             (target == Target::kNerfstudio || !IsFolderTarget(target) ? "z up" : "y down") +
             (settings.up == "z" ? " by the camera's upright axis" : " by gravity");
  return words;
}

std::vector<ColmapFile> EncodeColmap(const ColmapModel& model, const ExportSettings& settings) {
  const Form form = PlanOf(settings).form;
  std::vector<ColmapFile> files;
  if (form != Form::kBinary) files = EncodeColmapText(model);
  if (form != Form::kText) {
    for (ColmapFile& file : EncodeColmapBinary(model)) files.push_back(std::move(file));
  }
  return files;
}

void WriteExportFile(const std::string& path, const std::string& bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    ThrowInput(path + " is a folder; give the name of a file");
  }
  AtomicWriteFile(path, bytes);
}

void WriteCloud(const Cloud& cloud, const ExportSettings& settings, const std::string& out) {
  const Plan plan = PlanOf(settings);
  const auto format = plan.form == Form::kText ? CloudFormat::kAscii : CloudFormat::kBinary;
  WriteExportFile(
      out, plan.target == Target::kPly ? EncodePly(cloud, format) : EncodePcd(cloud, format));
}

std::string ExportMap(const SavedMap& saved, const ExportSettings& settings,
                      const std::string& out) {
  const Plan plan = PlanOf(settings);
  const MapPart part = PartFor(saved, settings);
  std::string what = std::to_string(part.landmarks.size()) + " points";
  switch (plan.target) {
    case Target::kMap:
      WriteExportFile(out, EncodeMap(saved));
      what = std::to_string(part.keyframes.size()) + " keyframes, " + what;
      break;
    case Target::kPly:
    case Target::kPcd:
      WriteCloud(CloudOf(saved, part), settings, out);
      break;
    case Target::kTum:
    case Target::kEvo:
    case Target::kKitti:
    case Target::kEuroc:
      if (settings.poses == "frames") ThrowUsage("--poses frames needs the result folder of a run");
      WriteExportFile(out, FormatTrajectory(TrajectoryOf(saved, part), settings));
      what = std::to_string(part.keyframes.size()) + " poses";
      break;
    case Target::kColmap: {
      ExportFolder folder(out);
      folder.Write(EncodeColmap(ColmapModelOf(saved, part), settings));
      folder.Place(settings.to);
      what = std::to_string(part.keyframes.size()) + " images, " + what;
      break;
    }
    case Target::kGsplat:
    case Target::kNerfstudio:
      ThrowUsage("--to " + settings.to + " needs the images: export the result folder of a run");
    case Target::kMcap:
      ExportMapToMcap(saved, part, out, "alidade " ALIDADE_VERSION);
      what = std::to_string(part.keyframes.size()) + " keyframes, " + what;
      break;
  }
  return what;
}

}  // namespace alidade
