// How the camera turns while there is no map: each image is compared with an earlier one of about
// the same direction, a view, by a rotation alone. Views of all directions are kept, so that errors
// do not grow while the camera turns on the spot.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/features/frame.h"

namespace ALIDADE_API alidade {

class TurnViews {
 public:
  struct Seen {
    int view = 0;  // its id, from 0
    Eigen::Matrix3d R_view_camera = Eigen::Matrix3d::Identity();
    // R_view_camera Exp(e) is the true rotation, e ~ N(0, covariance), rad². If the camera has
    // moved by t since the view, a rotation alone is off by about |t| over the mean distance, and
    // its residual, which is the spread of |t| over the distances, is a fifth of that (of distances
    // from 1 to 3: tests/geometry/rotation_fit_test.cc). It changes slowly: errors of images that
    // follow each other are not independent.
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double moved = 0;      // standard deviation of |t| over the mean distance
    bool at_spot = false;  // the view is of the spot the camera was at before
  };
  struct Step {
    std::optional<Seen> seen;
    std::optional<int> added;  // the image is a view now
    bool new_spot = false;     // and no rotation connects it with the spot before: the camera moved
    std::optional<int> dropped;
    Eigen::Matrix3d R_start_camera = Eigen::Matrix3d::Identity();
    // R_start_camera follows from an image, not from a guess alone.
    bool known = false;
  };

  // `match_scale`: features relative to 1000 (MonoStartSettings).
  explicit TurnViews(double match_scale) : match_scale_(match_scale) {}

  // The next image. `turn`: rotation since the last one (R_last_now) by a gyroscope; nullopt: as
  // between the last two.
  Step Add(const Frame& frame, const Camera& camera, const std::optional<Eigen::Matrix3d>& turn);
  // The camera has turned while images were not added.
  void Turned(const Eigen::Matrix3d& R_start_camera);
  void Reset();

 private:
  struct View {
    int id;
    std::shared_ptr<const Frame> frame;  // without images
    Eigen::Matrix3d R_start_view;
    int spot;      // number of the place where the camera turned
    int uses = 0;  // images that were compared with it
  };
  View* Nearest(const Eigen::Matrix3d& R_start_camera);
  std::optional<Seen> Compare(const View& view, const Frame& frame, const Camera& camera,
                              const Eigen::Matrix3d& R_view_camera, double radius) const;
  std::optional<int> MakeRoom();

  double match_scale_;
  std::vector<View> views_;  // oldest first
  int next_ = 0, spot_ = 0;
  Eigen::Matrix3d R_start_last_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d last_turn_ = Eigen::Matrix3d::Identity();
};

}  // namespace alidade
