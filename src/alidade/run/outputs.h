// Writes the result folder of `alidade run` (docs/reference/run-folder.md).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "alidade/run/folder/output_folder.h"
#include "alidade/run/results/mask_writer.h"
#include "alidade/run/results/record.h"

namespace alidade {

struct RunSummary {
  int frames = 0, tracked = 0;
  int keyframes = 0, landmarks = 0, maps = 0;
  std::optional<int> first_tracked;               // its number in the recording
  std::vector<std::array<double, 2>> lost_spans;  // seconds; not before the first pose
  size_t shape_points = 0;                        // points in semidense.ply
  double path_length = 0;  // through the largest map, meters (monocular: map units)
};

// Writes all files. Throws Error (input) if a file cannot be written; files written before are
// complete.
RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record,
                        bool with_map = true, MaskWriter* masks = nullptr);

}  // namespace alidade
