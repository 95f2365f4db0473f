// Random descriptors, single and in clusters, and frames of them.
#pragma once

#include <vector>

#include "alidade/base/random.h"
#include "alidade/features/frame.h"

namespace alidade {

inline Descriptor RandomDescriptor(Random& random) {
  Descriptor d;
  for (uint64_t& w : d.words) w = (static_cast<uint64_t>(random.Next()) << 32) | random.Next();
  return d;
}

inline Descriptor Flipped(Descriptor d, int bits, Random& random) {
  for (int bit : random.Sample(bits, 256)) d.words[bit / 64] ^= uint64_t{1} << (bit % 64);
  return d;
}

// `copies` noisy copies of each of `places` random descriptors.
inline std::vector<Descriptor> Clustered(int places, int copies, uint64_t seed) {
  Random random(seed);
  std::vector<Descriptor> sample;
  for (int p = 0; p < places; ++p) {
    const Descriptor centre = RandomDescriptor(random);
    for (int c = 0; c < copies; ++c) sample.push_back(Flipped(centre, 12, random));
  }
  return sample;
}

// A frame with these descriptors at random positions.
inline Frame FrameOf(std::vector<Descriptor> descriptors) {
  Frame frame;
  frame.keypoints.resize(descriptors.size());
  frame.descriptors = std::move(descriptors);
  return frame;
}

}  // namespace alidade
