// Writes the result folder of `alidade run` (docs/reference/run-folder.md).
#pragma once

#include "alidade/run/calibration/camera_finding.h"
#include "alidade/run/folder/output_folder.h"
#include "alidade/run/results/mask_writer.h"
#include "alidade/run/results/run_log.h"
#include "alidade/run/results/run_summary.h"
#include "alidade/run/setup/run_setup.h"

namespace alidade {

// Writes everything. `masks` may be null. Throws Error (input) when a file cannot be written; what
// was written by then is whole.
RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunSetup& setup,
                        const CameraFinding& camera, const RunLog& log, MaskWriter* masks);

}  // namespace alidade
