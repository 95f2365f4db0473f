// Opens a detector from an ONNX file of the YOLO family.
#pragma once

#include <memory>
#include <string>

#include "alidade/base/api.h"
#include "alidade/detect/detector.h"
#include "alidade/detect/settings.h"

namespace ALIDADE_API alidade {

// Reads the file and runs the network once on a gray image, so that unusable files fail here.
// Throws Error (input) naming the file when it is missing, damaged or not ONNX, needs an operator
// that OpenCV lacks, or has outputs that are not finite or not those of a known detector. Detect()
// throws likewise. docs/guides/detectors.md lists supported files and explains the choice of color order
// and size.
std::unique_ptr<Detector> OpenDetector(const std::string& path,
                                       const DetectorSettings& settings = {});

}  // namespace alidade
