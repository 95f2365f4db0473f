#include "alidade/run/report/result_picture.h"

#include <utility>

#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/run/folder/final_state.h"
#include "alidade/view/cloud_picture.h"

namespace alidade {

std::string PictureOfResult(const std::string& folder) {
  constexpr int kJpegQuality = 88;
  if (const std::string drawn = folder + "/semidense.png"; IsFile(drawn)) return ReadFile(drawn);
  FinalState state = FinalStateIn(folder);
  if (!state.landmarks || state.landmarks->points.empty()) return {};
  std::vector<Se3> path;
  for (const StampedPose& pose : state.trajectory) path.push_back(pose.T_world_camera);
  CloudScene scene{std::move(*state.landmarks), {std::move(path)}};
  CloudPictureSettings settings;
  settings.width = 900;
  settings.height = 600;
  return EncodeJpeg(DrawCloud(scene, CloudView::kBehind, settings), kJpegQuality);
}

}  // namespace alidade
