// A Python function as a detector.
#pragma once

#include <memory>

#include "alidade/detect/detector.h"
#include "python.h"

namespace alidade::python {

// `callable(image)` returns (class, score, x, y, width, height) for each detection; class: a name,
// or its number in COCO or in the callable's `class_names`. It is called in the detector's thread
// with the GIL. An exception becomes an Error, and SLAM continues without the detector.
// Construction and destruction do not require the GIL.
std::shared_ptr<Detector> DetectorOf(py::object callable);

// true in a call that `detector`'s function makes, in this thread.
bool IsCalledBy(const Detector* detector);

}  // namespace alidade::python
