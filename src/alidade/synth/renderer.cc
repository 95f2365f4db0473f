#include "alidade/synth/renderer.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/synth/tile_caster.h"

namespace alidade {
namespace {

constexpr int kTile = TileCaster::kTile;

Eigen::Vector3d EquidistantDirection(const Camera& camera, const Eigen::Vector2d& pixel) {
  RawCamera lens;
  lens.lens = Lens::kFisheye;
  lens.fx = camera.fx;
  lens.fy = camera.fy;
  lens.cx = camera.cx;
  lens.cy = camera.cy;
  return lens.Direction(pixel);
}

}  // namespace

ViewRenderer::ViewRenderer(const Scene& scene, const Camera& camera, bool fisheye)
    : scene_(scene),
      camera_(camera),
      columns_((camera.width + kTile - 1) / kTile),
      rows_((camera.height + kTile - 1) / kTile),
      planes_(PlanesOf(scene.rects)) {
  ray_x_.create(rows_ * kTile + 1, columns_ * kTile + 1);
  ray_y_.create(ray_x_.size());
  ParallelFor(ray_x_.rows, [&](int y) {
    for (int x = 0; x < ray_x_.cols; ++x) {
      const Eigen::Vector2d pixel(std::min(x, camera.width), std::min(y, camera.height));
      const Eigen::Vector3d ray = fisheye ? EquidistantDirection(camera_, pixel)
                                          : camera_.Unproject(camera_.Undistort(pixel));
      ray_x_(y, x) = static_cast<float>(ray.x() / ray.z());
      ray_y_(y, x) = static_cast<float>(ray.y() / ray.z());
    }
  });
}

RayBounds ViewRenderer::Bounds(const cv::Rect& pixels) const {
  const cv::Rect area = cv::Rect(pixels.x, pixels.y, pixels.width + 1, pixels.height + 1) &
                        cv::Rect({0, 0}, ray_x_.size());
  double left, right, top, bottom;
  cv::minMaxLoc(ray_x_(area), &left, &right);
  cv::minMaxLoc(ray_y_(area), &top, &bottom);
  // Samples are up to half a pixel away from the rays.
  const double half = 0.6 / std::min(camera_.fx, camera_.fy);
  return {static_cast<float>(left - half), static_cast<float>(right + half),
          static_cast<float>(top - half), static_cast<float>(bottom + half)};
}

// State of an image in progress.
struct ViewRenderer::Picture {
  const Shutter& shutter;
  View view;
  cv::Mat1i surfaces;             // surface at each pixel's center
  cv::Mat1f one_sample;           // gray level there
  std::vector<StageView> stages;  // one, or for a rolling shutter one per row of tiles
  std::vector<TileList> lists;    // one per tile

  const StageView& StageOf(int band) const {
    return stages[stages.size() > 1 ? static_cast<size_t>(band) : 0];
  }
};

View ViewRenderer::Render(const Shutter& shutter) const {
  const cv::Size size(camera_.width, camera_.height);
  Picture picture = {shutter,
                     {cv::Mat1f(size), cv::Mat1f(size), cv::Mat1b(size)},
                     cv::Mat1i(size),
                     cv::Mat1f(size),
                     {},
                     {}};
  picture.stages.resize(shutter.rolling ? static_cast<size_t>(rows_) : 1);
  picture.lists.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  const int stages = static_cast<int>(picture.stages.size()),
            height = shutter.rolling ? kTile : size.height;
  ParallelFor(stages, [&](int i) {
    const cv::Rect rows(0, i * height, size.width, std::min(height, size.height - i * height));
    picture.stages[i] =
        PrepareStage(scene_, planes_, shutter, rows.y, rows.y + rows.height - 1, Bounds(rows));
  });
  ParallelFor(rows_, [&](int band) { CastBand(band, picture); });
  picture.view.grey.copyTo(picture.one_sample);
  ParallelFor(rows_, [&](int band) { SmoothBand(band, picture); });
  return picture.view;
}

// One ray through the center of every pixel.
void ViewRenderer::CastBand(int band, Picture& picture) const {
  const StageView& stage = picture.StageOf(band);
  View& view = picture.view;
  for (int column = 0; column < columns_; ++column) {
    const int left = column * kTile, right = std::min(left + kTile, camera_.width);
    TileList& list = picture.lists[static_cast<size_t>(band) * columns_ + column];
    list = ListTile(stage, Bounds({left, band * kTile, kTile, kTile}));
    TileCaster caster(scene_, planes_, camera_, picture.shutter, stage, list);
    float inverse_z[kTile];
    int which[kTile];
    for (int y = band * kTile; y < std::min((band + 1) * kTile, camera_.height); ++y) {
      caster.SetRow(y);
      const float* ray_x = ray_x_[y] + left;
      const float* ray_y = ray_y_[y] + left;
      caster.Row(ray_x, ray_y, inverse_z, which);
      for (int x = left; x < right; ++x) {
        const int k = x - left;
        view.grey(y, x) = caster.Shade(which[k], ray_x[k], ray_y[k]);
        view.depth(y, x) = which[k] < 0 ? 0 : 1 / inverse_z[k];
        view.actor(y, x) = caster.IsActor(which[k]) ? 255 : 0;
        picture.surfaces(y, x) = caster.Surface(which[k]);
      }
    }
  }
}

namespace {

// Eight more rays per pixel, offsets from the center in sixteenths of its width; no two in one row
// or column.
constexpr int kSamples = 8;
constexpr float kOffsets[kSamples][2] = {{1, -3}, {-1, 3},  {5, 1}, {-3, -5},
                                         {-5, 5}, {-7, -1}, {3, 7}, {7, -7}};

// Mean gray level of the surfaces hit by a pixel's rays, each shaded once at the mean of its rays.
float ShadeMixed(const TileCaster& caster, const float (&x)[kSamples], const float (&y)[kSamples]) {
  int which[kSamples];
  for (int i = 0; i < kSamples; ++i) which[i] = caster.Cast(x[i], y[i]);
  bool done[kSamples] = {};
  float sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    if (done[i]) continue;
    float sum_x = 0, sum_y = 0, count = 0;
    for (int k = i; k < kSamples; ++k) {
      if (which[k] != which[i]) continue;
      done[k] = true;
      sum_x += x[k];
      sum_y += y[k];
      count += 1;
    }
    // The mean ray may miss a surface with a curved outline.
    float mean_x = sum_x / count, mean_y = sum_y / count;
    if (!caster.Meets(which[i], mean_x, mean_y)) {
      mean_x = x[i];
      mean_y = y[i];
    }
    sum += count * caster.Shade(which[i], mean_x, mean_y);
  }
  return sum / kSamples;
}

}  // namespace

// Antialiasing: pixels on outlines of surfaces average all surfaces they touch, so that edges are
// accurate to a fraction of a pixel.
void ViewRenderer::SmoothBand(int band, Picture& picture) const {
  constexpr float kContrast = 2;  // gray levels; smaller differences are not antialiased
  const int width = camera_.width, height = camera_.height;
  for (int column = 0; column < columns_; ++column) {
    const TileList& list = picture.lists[static_cast<size_t>(band) * columns_ + column];
    TileCaster caster(scene_, planes_, camera_, picture.shutter, picture.StageOf(band), list);
    const int left = column * kTile, right = std::min(left + kTile, width);
    for (int y = band * kTile; y < std::min((band + 1) * kTile, height); ++y) {
      bool row_set = false;
      for (int x = left; x < right; ++x) {
        const int surface = picture.surfaces(y, x);
        const float grey = picture.one_sample(y, x);
        const auto differs = [&](int y2, int x2) {
          return y2 >= 0 && y2 < height && x2 >= 0 && x2 < width &&
                 picture.surfaces(y2, x2) != surface &&
                 std::abs(picture.one_sample(y2, x2) - grey) > kContrast;
        };
        if (!differs(y, x - 1) && !differs(y, x + 1) && !differs(y - 1, x) && !differs(y + 1, x))
          continue;
        if (!row_set) caster.SetRow(y);
        row_set = true;
        const float ray_x = ray_x_(y, x), ray_y = ray_y_(y, x);
        const float right_x = ray_x_(y, x + 1) - ray_x, right_y = ray_y_(y, x + 1) - ray_y;
        const float down_x = ray_x_(y + 1, x) - ray_x, down_y = ray_y_(y + 1, x) - ray_y;
        float xs[kSamples], ys[kSamples];
        for (int i = 0; i < kSamples; ++i) {
          const float a = kOffsets[i][0] / 16, b = kOffsets[i][1] / 16;
          xs[i] = ray_x + a * right_x + b * down_x;
          ys[i] = ray_y + a * right_y + b * down_y;
        }
        picture.view.grey(y, x) = ShadeMixed(caster, xs, ys);
      }
    }
  }
}

}  // namespace alidade
