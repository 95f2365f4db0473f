// Input of one frame, checked, and turned into what the tracker takes.
#pragma once

#include <memory>

#include "alidade/features/picture.h"
#include "alidade/geometry/camera.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace alidade {

// The camera as used: without what the sensor setting leaves aside, scaled by the profile. Throws
// Error (input) when the sensor asks for what the camera has not.
Camera CameraInUse(Camera camera, const SlamSettings& settings);

// Images in grey, of the size of `used`, only those the sensor setting asks for. Throws Error
// (input) on images that are not of the size of `given`, or of a type that cannot be.
FrameInput Prepare(const FrameInput& input, const Camera& given, const Camera& used,
                   const SlamSettings& settings);

// Refers to the images of `input`, which are the caller's.
std::shared_ptr<const Picture> PictureOf(const FrameInput& input);
// With images of its own.
std::shared_ptr<const Picture> Copied(const Picture& picture);

}  // namespace alidade
