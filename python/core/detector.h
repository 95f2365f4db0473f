// A Python function as the detector.
#pragma once

#include <memory>

#include "alidade/detect/detector.h"
#include "python.h"

namespace alidade::python {

// `callable(image)` gives (class, score, x, y, width, height) of each thing; class: a name, or its
// number in COCO or in the callable's own `class_names`. It is called from the thread that has the
// image, with the GIL; what it raises becomes an Error, with which it is done without. Made and
// destroyed with or without the GIL.
std::shared_ptr<Detector> DetectorOf(py::object callable);

}  // namespace alidade::python
