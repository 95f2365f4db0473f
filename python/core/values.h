// Conversion of plain values between Python and the library: cameras, inertial sensors, options of
// a run. All functions require the GIL.
#pragma once

#include <string>

#include "alidade/geometry/camera.h"
#include "alidade/inertial/imu.h"
#include "alidade/run/setup/options.h"
#include "python.h"

namespace alidade::python {

// Convert alidade.Camera. CameraFrom() throws Error (input) naming an invalid field.
Camera CameraFrom(const py::handle& value);
py::object CameraObject(const Camera& camera);

// Convert alidade.Imu. ImuFrom() throws Error (usage) naming an invalid field.
ImuModel ImuFrom(const py::handle& value);
py::object ImuObject(const ImuModel& imu);

// Text that may hold a path: bytes that are not UTF-8 become surrogate escapes, as in
// os.fsdecode().
py::str PathText(const std::string& text);

// Options by RunOptions' field names; None keeps the default. Throws Error (usage) for an unknown
// name or a value of the wrong type.
RunOptions OptionsFrom(const py::dict& values);

}  // namespace alidade::python
