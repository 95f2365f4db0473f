// Checks the input of one frame and converts it to what the tracker takes.
#pragma once

#include <memory>

#include "alidade/features/picture.h"
#include "alidade/geometry/camera.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace alidade {

// The camera in use: without the baseline or depth factor that the sensor setting ignores, scaled
// down to settings.image_width or max_image_side; with settings.localize also up to image_width.
// Throws Error (input) if the sensor setting needs a baseline or depth factor that the camera does
// not have.
Camera CameraInUse(Camera camera, const SlamSettings& settings);

// Width to which images of `camera` are scaled so that a pixel covers the same angle as in `map`,
// the camera of a map: at most `max_side` pixels on the longer side (0: any), and at most three
// times as wide as they are. Beyond that, what is seen is that of a camera farther away.
int WidthAtResolutionOf(const Camera& map, const Camera& camera, int max_side);

// Number of features that makes them as dense in the images of `camera` as `features` are in those
// of `map`, which has the same resolution: more in a wider view, at most six times as many.
int FeaturesAsDenseAs(const Camera& map, const Camera& camera, int features);

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
