// Checks the input of one frame and converts it to what the tracker takes.
#pragma once

#include <memory>

#include "alidade/features/picture.h"
#include "alidade/geometry/camera.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace alidade {

// The camera in use: without the baseline or depth factor that the sensor setting ignores, scaled
// down to settings.image_width or max_image_side. Throws Error (input) if the sensor setting needs
// a baseline or depth factor that the camera does not have.
Camera CameraInUse(Camera camera, const SlamSettings& settings);

// Gray images of the size of `used`, and of right and depth image only what the sensor setting
// uses; the color image if the settings need it. Throws Error (input) if an image does not have the
// size of `given` or has an unsupported type, or if the time is not finite.
FrameInput Prepare(const FrameInput& input, const Camera& given, const Camera& used,
                   const SlamSettings& settings);

// Shares the images of `input`, whose memory belongs to the caller.
std::shared_ptr<const Picture> PictureOf(const FrameInput& input);
// A copy that owns its images.
std::shared_ptr<const Picture> Copied(const Picture& picture);

}  // namespace alidade
