// The folder `alidade run` leaves behind (docs/formats.md).
#pragma once

#include "alidade/run/mask_writer.h"
#include "alidade/run/output_folder.h"
#include "alidade/run/record.h"

namespace alidade {

struct RunSummary {
  int frames = 0, tracked = 0;
  int keyframes = 0, landmarks = 0, maps = 0;
  size_t shape_points = 0;  // of semidense.ply
  double path_length = 0;   // metres (mono: map units)
};

// Writes everything. Throws Error (input) when a file cannot be written; what stays then is whole,
// and is nothing at all unless stats.json is among it.
RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record,
                        bool with_map = true, MaskWriter* masks = nullptr);

}  // namespace alidade
