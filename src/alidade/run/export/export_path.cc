#include "alidade/run/export/export_path.h"

#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/run/export/map_scale.h"
#include "alidade/run/export/mcap_export.h"
#include "alidade/run/export/nerfstudio_files.h"
#include "alidade/run/export/training_preview.h"
#include "alidade/run/export/trajectory_export.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/sources/saved_map.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/version.h"

namespace alidade {
namespace {

constexpr int kPreviewQuality = 90;  // JPEG

std::string InWords(const McapCounts& counts, const char* frames) {
  char megabytes[32];
  PrintTo(megabytes, sizeof megabytes, "%.1f MB", 1e-6 * static_cast<double>(counts.bytes));
  const std::string shape =
      counts.shape > 0 ? std::to_string(counts.shape) + " semi-dense points, " : "";
  return std::to_string(counts.frames) + " " + frames + ", " + std::to_string(counts.landmarks) +
         " landmarks, " + shape + megabytes;
}

// How the map was moved.
struct Move {
  Sim3 T_now_then;
  Sim3 T_now_written;  // from the world of the folder's trajectories
};

// Gives the map its unit, and makes it upright.
Move MoveAsAsked(const std::string& path, const ExportSettings& settings, SavedMap& saved) {
  Move move;
  move.T_now_then.s = ScaleFor(path, saved, settings);
  move.T_now_then.R = TurnFor(saved, settings);
  move.T_now_written = move.T_now_then;
  ExportSettings all = settings;  // rarely seen landmarks, too
  all.min_observations = 1;
  const MapPart part = PartFor(saved, all);
  if (!move.T_now_then.R.isIdentity(0)) {
    move.T_now_written.R *= WrittenTurnIn(saved, part, ResultFolderOf(path)).transpose();
    MoveMap(saved, part, {1, move.T_now_then.R, Eigen::Vector3d::Zero()});
  }
  if (settings.scale_by) ScaleMap(saved, part, move.T_now_then.s);
  return move;
}

std::string ExportToMcap(const std::string& path, const ExportSettings& settings,
                         const std::string& out) {
  const std::string stream = StreamIn(path), program = "alidade " ALIDADE_VERSION;
  std::error_code error;
  if (std::filesystem::equivalent(stream.empty() ? path : stream, out, error))
    ThrowUsage("OUT is the source itself; choose another file");
  CheckIsNoResult(out);
  const bool map = stream.empty() && !std::filesystem::is_directory(path, error);
  if (!map && settings.scale_by)
    ThrowUsage("--scale-by with --to mcap applies to a map: give the file map.alidade");
  if (!map && (settings.part != 0 || settings.min_observations > 1)) {
    ThrowUsage("--part and --min-observations apply to a map: give the file map.alidade");
  }
  if (map) {
    SavedMap saved = ReadSavedMap(path);
    MoveAsAsked(path, settings, saved);
    return InWords(ExportMapToMcap(saved, PartFor(saved, settings), out, program), "keyframes");
  }
  return InWords(
      stream.empty() ? ExportResults(path, out, program) : ExportStream(stream, out, program),
      "frames");
}

std::string InWords(const TrainingSet& set) {
  const Camera& camera = set.model.camera;
  std::string words = std::to_string(set.model.images.size()) + " images of " +
                      std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                      (set.masks ? " with masks, " : ", ") +
                      std::to_string(set.model.points.size()) + " points";
  const auto without = [&](int keyframes, const char* why) {
    if (keyframes == 0) return;
    words += "; without " + std::to_string(keyframes) +
             (keyframes == 1 ? " keyframe " : " keyframes ") + why;
  };
  without(set.other, "of which the recording has another image");
  without(set.missing, "that the recording does not have");
  return words;
}

std::string ExportImages(const std::string& path, const SavedMap& saved,
                         const ExportSettings& settings, const Move& move, const std::string& out,
                         const ExportProgress& progress) {
  const MapPart part = PartFor(saved, settings);
  if (part.keyframes.empty()) ThrowInput(path + ": the map is empty");
  ExportFolder folder(out);  // before the recording is read
  OwnRecording recording = OpenOwnRecording(path, saved, settings.source, settings.camera);
  recording.T_now_then = move.T_now_then;
  TrainingSettings training;
  training.choice = FrameChoiceNamed(settings.images);
  training.min_observations = settings.LeastObservations();
  training.centered = settings.to == "gsplat";
  training.masks = settings.masks;
  const TrainingSet set = WriteTrainingImages(saved, part, recording, training, progress, folder);
  if (const cv::Mat preview = TrainingPreview(set); !preview.empty())
    folder.Write("preview.jpg", EncodeJpeg(preview, kPreviewQuality));
  if (settings.to == "nerfstudio") {
    folder.Write("transforms.json", NerfstudioJson(set.model, set.masks));
    folder.Write("sparse_pc.ply", EncodePly(NerfstudioCloud(set.model), CloudFormat::kBinary));
  } else {
    folder.Write(EncodeColmap(set.model, settings), "sparse/0/");
  }
  folder.Place(settings.to);
  return InWords(set);
}

// "120 poses" with the world they are in.
std::string Told(const std::string& what, const SavedMap& saved, const ExportSettings& settings) {
  const std::string world = WorldInWords(saved, settings);
  return world.empty() ? what : what + ", " + world;
}

// Of a map that was moved as asked.
std::string WriteExport(const std::string& path, const SavedMap& saved,
                        const ExportSettings& settings, const Move& move, const std::string& out,
                        const ExportProgress& progress) {
  if (settings.IsTrajectory())
    return ExportTrajectory(path, saved, settings, move.T_now_written, out);
  if (settings.colors) {
    const MapPart part = PartFor(saved, settings);
    OwnRecording recording = OpenOwnRecording(path, saved, settings.source, settings.camera);
    recording.T_now_then = move.T_now_then;
    const Cloud cloud = ColoredCloud(saved, part, recording, progress);
    WriteCloud(cloud, settings, out);
    return std::to_string(cloud.points.size()) + " colored points";
  }
  if (settings.WithImages()) return ExportImages(path, saved, settings, move, out, progress);
  return ExportMap(saved, settings, out);
}

}  // namespace

std::string ExportSaved(SavedMap saved, const ExportSettings& settings, const std::string& out) {
  settings.Check();
  MoveAsAsked("", settings, saved);
  return Told(ExportMap(saved, settings, out), saved, settings);
}

std::string ExportPath(const std::string& path, const ExportSettings& settings,
                       const std::string& out, const ExportProgress& progress) {
  settings.Check();
  if (settings.to == "mcap") return ExportToMcap(path, settings, out);
  std::error_code error;
  if (std::filesystem::equivalent(SavedMapPath(path), out, error)) {
    ThrowUsage("OUT is the map itself; choose another file");
  }
  CheckIsNoResult(out);
  SavedMap saved = ReadSavedMap(path);
  const Move move = MoveAsAsked(path, settings, saved);
  return Told(WriteExport(path, saved, settings, move, out, progress), saved, settings);
}

}  // namespace alidade
