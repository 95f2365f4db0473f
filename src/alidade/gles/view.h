// Viewpoint, layers, colors and layout of the renderer.
#pragma once

#include <array>

#include "alidade/geometry/se3.h"

namespace alidade::gles {

// Red, green, blue; 0…1.
using Color = std::array<float, 3>;

// Those of the viewer's page in the dark.
struct Colors {
  Color background{0.055f, 0.063f, 0.075f};
  Color landmarks{0.467f, 0.506f, 0.549f};
  Color path{0.353f, 0.663f, 1.0f};
  Color keyframes{0.639f, 0.678f, 0.722f};
  Color tracked{0.184f, 0.718f, 0.408f};  // the camera of the last frame
  Color lost{0.941f, 0.408f, 0.365f};     // where its motion leads
  Color matched{0.122f, 0.714f, 0.910f};  // a feature whose landmark agrees with the pose
  Color fresh{0.902f, 0.624f, 0.0f};      // of a new landmark
  Color moving{0.831f, 0.227f, 0.184f};   // left out
  Color unmatched{0.725f, 0.757f, 0.792f};
};

// A part of the screen, in shares of its width and height from the top left corner; none: not
// drawn.
struct Area {
  double left = 0, top = 0, width = 1, height = 1;
  bool none() const { return !(width > 0 && height > 0); }
};

struct ViewSettings {
  // Where the two are. The smaller one lies in front.
  Area map{0, 0, 1, 1};
  Area picture{0, 0, 0.3, 0.3};

  // The eye: x right, y down, z forward, as cameras have it. A point z before it, at x, is drawn
  // f * x / z pixels right of the middle of the map's area, with f = height / (2 tan(fov / 2)).
  Se3 T_world_eye;
  double fov = 0.9;       // vertical, radians
  double nearest = 0.01;  // what is nearer to the eye is cut off, world units; above 0

  // Layers.
  bool landmarks = true, points = true, path = true, keyframes = true, camera = true;
  bool features = true, unmatched_features = false;
  // Of maps that are not the one the camera is in, each in a world of its own: strength 0 (not
  // drawn) to 1.
  double other_maps = 0;

  // Sizes, pixels. On screens with small pixels multiply by their density.
  double landmark_size = 3, point_size = 2, feature_size = 6, line_width = 2;
  // Depth of the frusta, world units; 0: a twentieth of the median distance of landmarks from their
  // keyframes. The camera's is twice as large.
  double frustum = 0;
  Colors colors;

  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade::gles
