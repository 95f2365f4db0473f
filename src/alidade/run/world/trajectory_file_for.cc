#include "alidade/run/world/trajectory_file_for.h"

#include <algorithm>
#include <vector>

#include "alidade/io/files/file.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/folder/own_files.h"

namespace alidade {

std::string TrajectoryFileFor(const SavedMap& saved, const MapPart& part,
                              const std::string& folder) {
  constexpr double kSameMoment = 1e-6;  // seconds
  std::vector<double> times;            // of the keyframes
  for (KeyFrameId id : part.keyframes) times.push_back(saved.map.Find(id)->frame->time);
  std::sort(times.begin(), times.end());
  std::string best;
  size_t most = 0;
  for (size_t number = 0;; ++number) {
    const std::string list = folder + "/" + NumberedFile("keyframes", number),
                      file = folder + "/" + NumberedFile("trajectory", number);
    if (folder.empty() || !IsFile(list) || !IsFile(file)) return best;
    size_t found = 0;
    for (const StampedPose& pose : ReadTrajectory(list)) {
      const auto at = std::lower_bound(times.begin(), times.end(), pose.time - kSameMoment);
      if (at != times.end() && *at <= pose.time + kSameMoment) ++found;
    }
    if (found > most) {
      most = found;
      best = file;
    }
  }
}

}  // namespace alidade
