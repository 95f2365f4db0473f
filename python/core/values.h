// Plain values between Python and the library: cameras, options of a run. All need the GIL.
#pragma once

#include <string>

#include "alidade/geometry/camera.h"
#include "alidade/run/options.h"
#include "python.h"

namespace alidade::python {

// From and to alidade.Camera. From: throws Error (input) naming the field that cannot be.
Camera CameraFrom(const py::handle& value);
py::object CameraObject(const Camera& camera);

// By the names RunOptions has them; what is None stays as it is by default. Throws Error (usage)
// for a name there is not, or a value of another type.
RunOptions OptionsFrom(const py::dict& values);

}  // namespace alidade::python
