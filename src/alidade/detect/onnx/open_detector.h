// A detector from an ONNX file of the YOLO family.
#pragma once

#include <memory>
#include <string>

#include "alidade/base/api.h"
#include "alidade/detect/detector.h"
#include "alidade/detect/settings.h"

namespace ALIDADE_API alidade {

// Reads the file and runs the network once on a grey picture, so that what cannot work fails here:
// throws Error (input) naming the file when it is missing, no ONNX, damaged, needs an operator that
// OpenCV doesn't have, or gives outputs that are no known detector's or not finite. So does Detect.
// Which files work, and how colours and sizes are chosen: docs/guides/detectors.md.
std::unique_ptr<Detector> OpenDetector(const std::string& path,
                                       const DetectorSettings& settings = {});

}  // namespace alidade
