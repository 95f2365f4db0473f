#include "alidade/semidense/packed_depth.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace alidade {

PackedDepth::PackedDepth(std::span<const Hypothesis> depth) : packed_(depth.size()) {
  float most = 0;
  for (const Hypothesis& h : depth) most = std::max(most, h.known() ? h.inverse_depth : 0);
  if (!(most > 0)) return;
  step_ = most / 65535;
  for (size_t i = 0; i < depth.size(); ++i) {
    if (!depth[i].known()) continue;
    const long steps = std::lround(depth[i].inverse_depth / step_);
    packed_[i].inverse_depth = static_cast<uint16_t>(std::clamp(steps, 1L, 65535L));
    const uint32_t sigma = Eigen::numext::bit_cast<uint32_t>(depth[i].sigma);
    packed_[i].sigma = static_cast<uint16_t>(std::max(1u, (sigma + 0x8000) >> 16));
  }
}

std::vector<Hypothesis> PackedDepth::Unpack(double growth) const {
  std::vector<Hypothesis> depth(packed_.size());
  const float step = step_ * static_cast<float>(growth), scale = static_cast<float>(growth);
  for (size_t i = 0; i < depth.size(); ++i) {
    const uint32_t sigma = static_cast<uint32_t>(packed_[i].sigma) << 16;
    depth[i] = {step * static_cast<float>(packed_[i].inverse_depth),
                scale * Eigen::numext::bit_cast<float>(sigma)};
  }
  return depth;
}

}  // namespace alidade
