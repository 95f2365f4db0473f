#include "alidade/surface/occupancy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/base/error.h"
#include "alidade/surface/voxel_blocks.h"

namespace alidade {
namespace {

// Share of wrong matches, with errors of more than three standard deviations: 2 to 4 % on the
// floors of rendered rooms, 8 to 12 % at edges.
constexpr double kWrong = 0.1;
constexpr double kMostCells = 1e6;      // from the origin
constexpr size_t kMostTiles = 400'000;  // 100 million columns

float LogOdds(double probability) {
  return static_cast<float>(std::log(probability / (1 - probability)));
}

// Parts of a ray, from 0 to 1, between two heights.
bool ClipToHeights(double from, double to, double low, double high, double& begin, double& end) {
  const double rise = to - from;
  if (std::abs(rise) < 1e-12) return from >= low && from <= high;
  double a = (low - from) / rise, b = (high - from) / rise;
  if (a > b) std::swap(a, b);
  begin = std::max(begin, a);
  end = std::min(end, b);
  return begin < end;
}

}  // namespace

double OccupancySettings::RangeFor(double inverse_sigma) const {
  const double certain = RangeAt(inverse_sigma, most_sigma * cell);
  return range > 0 ? std::min(range, certain) : certain;
}

double OccupancySettings::SharpRange(const DenseView& view) const {
  const double sharp = RangeAt(view.inverse_sigma, cell);
  return range > 0 ? std::min(range, sharp) : sharp;
}

void OccupancySettings::Check() const {
  if (!(cell >= 1e-3 && cell <= 100)) ThrowUsage("cell: must be from 0.001 to 100");
  if (!(clearance > 0)) ThrowUsage("clearance: must be positive");
  if (!(height > clearance && height <= 1000 * cell))
    ThrowUsage("height: must be more than the clearance, and at most 1000 cells");
  if (!(range >= 0)) ThrowUsage("range: must not be negative");
  if (!(most_sigma > 0)) ThrowUsage("most_sigma: must be positive");
  if (!(hit > 0.5 && hit < 1)) ThrowUsage("hit: must be between 0.5 and 1");
  if (!(pass > 0 && pass < 0.5)) ThrowUsage("pass: must be between 0 and 0.5");
  if (!(floor > 0 && floor < 0.5)) ThrowUsage("floor: must be between 0 and 0.5");
  if (!(least > 0 && least < free && free < occupied && occupied < most && most < 1))
    ThrowUsage("least < free < occupied < most must hold between 0 and 1");
}

OccupancyMap::OccupancyMap(const OccupancySettings& settings, const Se3& T_floor_world)
    : settings_(settings), T_floor_world_(T_floor_world) {
  settings.Check();
  layers_ = 1 + static_cast<int>(
                    std::ceil((settings.height - settings.clearance) / settings.cell - 1e-9));
  pass_ = LogOdds(settings.pass);
  floor_ = LogOdds(settings.floor);
  least_ = LogOdds(settings.least);
  most_ = LogOdds(settings.most);
}

Eigen::Vector3d OccupancyMap::InVoxels(const Eigen::Vector3d& p) const {
  return {p.x() / settings_.cell, p.y() / settings_.cell,
          (p.z() - settings_.clearance) / settings_.cell + 1};
}

OccupancyMap::Tile& OccupancyMap::TileAt(int x, int y) {
  if (last_ < tiles_.size() && tiles_[last_].x == x && tiles_[last_].y == y) return tiles_[last_];
  const auto [entry, added] = index_.emplace(KeyOf({x, y, 0}), tiles_.size());
  if (added) {
    if (tiles_.size() >= kMostTiles)
      ThrowUsage("the grid has more than 100 million cells: choose larger ones");
    const size_t voxels = static_cast<size_t>(kTile * kTile) * static_cast<size_t>(layers_);
    tiles_.push_back({x, y, std::vector<float>(voxels), std::vector<uint32_t>(voxels)});
  }
  last_ = entry->second;
  return tiles_[last_];
}

size_t OccupancyMap::IndexIn(int x, int y, int layer) const {
  return static_cast<size_t>(((y & (kTile - 1)) * kTile + (x & (kTile - 1))) * layers_ + layer);
}

void OccupancyMap::Update(int x, int y, int layer, uint32_t mark, float change) {
  Tile& tile = TileAt(x >> 4, y >> 4);
  const size_t index = IndexIn(x, y, layer);
  if (tile.seen[index] >= 2 * image_) return;  // once by each image; a reading comes before rays
  tile.seen[index] = mark;
  tile.log_odds[index] = std::clamp(tile.log_odds[index] + change, least_, most_);
}

void OccupancyMap::HitAlong(const Reading& reading) {
  const double step = settings_.cell / reading.ray.norm();  // of depth
  const int reach = static_cast<int>(2 * reading.sigma / step);
  if (reach == 0) return Hit(reading.At(reading.z), reading.z, 1, 0);
  std::vector<double> parts;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    parts.push_back(std::exp(-0.5 * std::pow(i * step / reading.sigma, 2)));
    sum += parts.back();
  }
  double beyond = 1;
  for (int i = -reach; i <= reach; ++i) {
    const double part = parts[static_cast<size_t>(i + reach)] / sum;
    beyond -= part;
    Hit(reading.At(reading.z + i * step), reading.z, part, beyond);
  }
}

void OccupancyMap::Hit(const Eigen::Vector3d& p_floor, double z, double ends, double passes) {
  const Eigen::Vector3i at = InVoxels(p_floor).array().floor().cast<int>();
  if (at.z() < 1 || at.z() >= layers_ || !HasKey(at)) return;
  Hits& hits = hits_[KeyOf(at)];
  if (hits.rays++ == 0) hits.z = z;
  hits.ends += ends;
  hits.passes += passes;
}

// `rays_at_one`: rays along a cell's edge at a depth of one meter.
void OccupancyMap::UseHits(double rays_at_one) {
  // Of the rays: a third, since a surface rarely fills a voxel from edge to edge.
  constexpr double kEnough = 0.3;
  for (const auto& [key, hits] : hits_) {
    const Eigen::Vector3i at = PlaceOf(key);
    const double across = std::max(1.0, rays_at_one / hits.z),
                 ends = std::min(1.0, hits.ends / (kEnough * across * across)),
                 passes = hits.passes / hits.rays;
    Update(at.x(), at.y(), at.z(), 2 * image_ + 1,
           static_cast<float>(ends) * LogOdds(settings_.hit) + static_cast<float>(passes) * pass_);
  }
  hits_.clear();
}

void OccupancyMap::SeeFloor(const Eigen::Vector3d& p_floor, double evidence) {
  const Eigen::Vector3d place = InVoxels(p_floor);
  const Eigen::Vector3i at(static_cast<int>(std::floor(place.x())),
                           static_cast<int>(std::floor(place.y())), 0);
  if (!HasKey(at)) return;
  SeenFloor& seen = floors_[KeyOf(at)];
  ++seen.count;
  seen.evidence += evidence;
}

void OccupancyMap::UseFloors() {
  for (const auto& [key, seen] : floors_) {
    const Eigen::Vector3i at = PlaceOf(key);
    // Readings of one image in a cell share a window of matching: their mean counts, not their sum.
    const float evidence = std::max(floor_, static_cast<float>(seen.evidence / seen.count));
    if (evidence < pass_) Update(at.x(), at.y(), 0, 2 * image_ + 1, evidence);
  }
  floors_.clear();
}

void OccupancyMap::Pass(int x, int y, int layer) { Update(x, y, layer, 2 * image_, pass_); }

// Amanatides & Woo 1987.
void OccupancyMap::PassAlong(const Ray& ray) {
  const Eigen::Vector3d step = ray.to - ray.from;
  double begin = 0, end = 1;
  if (!ClipToHeights(ray.from.z(), ray.to.z(), 0, layers_, begin, end)) return;
  Eigen::Vector3i at, last;
  const Eigen::Vector3d start = ray.from + begin * step, stop = ray.from + end * step;
  for (int i = 0; i < 3; ++i) {
    at[i] = static_cast<int>(std::floor(start[i]));
    last[i] = static_cast<int>(std::floor(stop[i]));
  }
  at.z() = std::clamp(at.z(), 0, layers_ - 1);
  last.z() = std::clamp(last.z(), 0, layers_ - 1);
  Eigen::Vector3d next, width;
  Eigen::Vector3i sign;
  for (int i = 0; i < 3; ++i) {
    sign[i] = step[i] > 0 ? 1 : -1;
    width[i] = step[i] == 0 ? INFINITY : std::abs(1 / step[i]);
    const double edge = at[i] + (step[i] > 0 ? 1 : 0);
    next[i] = step[i] == 0 ? INFINITY : (edge - ray.from[i]) / step[i];
  }
  const int most = (last - at).cwiseAbs().sum();
  for (int i = 0; i <= most; ++i) {
    if (at.z() >= 0 && at.z() < layers_) Pass(at.x(), at.y(), at.z());
    int axis = 0;
    next.minCoeff(&axis);
    if (next[axis] > end) break;
    at[axis] += sign[axis];
    next[axis] += width[axis];
  }
}

void OccupancyMap::Add(const DenseView& view) {
  ++image_;
  const double range = settings_.RangeFor(view.inverse_sigma);
  // At the range two rays are a quarter of a cell apart; along a floor seen at 15°, a cell.
  const int skip = std::isfinite(range)
                       ? std::max(1, static_cast<int>(view.camera.fx * settings_.cell / range / 4))
                       : 1;
  const Se3 T_floor_camera = T_floor_world_ * view.T_world_camera;
  const Eigen::Vector3d from = InVoxels(T_floor_camera.t);
  if (!(from.head<2>().cwiseAbs().maxCoeff() < kMostCells)) return;
  std::vector<Ray> rays;
  for (int y = skip / 2; y < view.depth.rows; y += skip) {
    for (int x = skip / 2; x < view.depth.cols; x += skip) {
      const double z = view.depth(y, x);
      if (!(z > 0)) continue;
      const double inverse_sigma = view.InverseSigmaAt(x, y);
      const Reading reading{T_floor_camera.t, T_floor_camera.R * view.camera.Unproject({x, y}), z,
                            z * z * inverse_sigma};
      const double own_range = settings_.RangeFor(inverse_sigma);
      const double clear = std::min(Use(reading, own_range), own_range);
      if (clear > 0) rays.push_back({from, InVoxels(reading.At(clear))});
    }
  }
  UseFloors();
  UseHits(view.camera.fx * settings_.cell / skip);
  for (const Ray& ray : rays) PassAlong(ray);
}

// The floor against the lowest thing that is an obstacle, by the likelihood of the height read, of
// which kWrong is spread evenly over the robot's height.
double OccupancyMap::FloorEvidence(double height, double sigma) const {
  const double s = std::max(sigma, 1e-6);
  const auto likelihood = [&](double off) {
    const double right = std::exp(-0.5 * off * off / (s * s)) / (s * std::sqrt(2 * M_PI));
    return (1 - kWrong) * right + kWrong / settings_.height;
  };
  return std::log(likelihood(std::max(0.0, settings_.clearance - height)) / likelihood(height));
}

double OccupancyMap::Use(const Reading& reading, double range) {
  const double z = reading.z, rise = reading.ray.z(), top = reading.camera.z(),
               height = top + z * rise, sigma_height = reading.sigma * std::abs(rise);
  // What stands at the end begins before it, by the error of the reading: two standard deviations
  // of inverse depth.
  const double clear = z / (1 + 2 * reading.sigma / z);
  if (height > settings_.clearance + 2 * sigma_height) {
    if (z <= range) HitAlong(reading);
    return clear;
  }
  if (!(rise < 0) || top <= settings_.clearance) return 0;
  const double floor = -top / rise,
               low = floor + 1.001 * settings_.clearance / rise;  // just above it
  // Clearly short of the plane: something low, which is driven over, or the foot of a wall.
  const double at = z + 2 * reading.sigma < floor ? z : floor;
  const double evidence = FloorEvidence(height, sigma_height);
  if (evidence < 0 && !(settings_.range > 0 && at > settings_.range))
    SeeFloor(reading.At(at), evidence);
  return std::min(clear, low);
}

int8_t OccupancyMap::StateOf(const Tile& tile, int x, int y) const {
  const size_t first = IndexIn(x, y, 0);
  float highest = -std::numeric_limits<float>::infinity();
  for (size_t i = 1; i < static_cast<size_t>(layers_); ++i) {
    if (tile.seen[first + i] > 0) highest = std::max(highest, tile.log_odds[first + i]);
  }
  if (highest > LogOdds(settings_.occupied)) return 100;
  return tile.log_odds[first] + std::max(0.0f, highest) < LogOdds(settings_.free) ? 0 : -1;
}

OccupancyPicture OccupancyMap::Picture() const {
  OccupancyPicture picture;
  picture.cell = settings_.cell;
  int left = std::numeric_limits<int>::max(), low = left, right = -left, high = -left;
  const auto for_each_known = [&](const auto& use) {
    for (const Tile& tile : tiles_) {
      for (int i = 0; i < kTile * kTile; ++i) {
        const int x = tile.x * kTile + i % kTile, y = tile.y * kTile + i / kTile;
        const int8_t state = StateOf(tile, x, y);
        if (state >= 0) use(x, y, state);
      }
    }
  };
  for_each_known([&](int x, int y, int8_t) {
    left = std::min(left, x);
    right = std::max(right, x);
    low = std::min(low, y);
    high = std::max(high, y);
  });
  if (right < left) return picture;
  picture.width = right - left + 1;
  picture.height = high - low + 1;
  picture.x = left * settings_.cell;
  picture.y = low * settings_.cell;
  picture.cells.assign(static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height),
                       -1);
  for_each_known([&](int x, int y, int8_t state) {
    picture.cells[static_cast<size_t>(y - low) * static_cast<size_t>(picture.width) +
                  static_cast<size_t>(x - left)] = state;
  });
  return picture;
}

size_t OccupancyMap::bytes() const {
  return tiles_.size() * static_cast<size_t>(kTile * kTile) * static_cast<size_t>(layers_) * 8;
}

}  // namespace alidade
