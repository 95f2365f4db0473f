// Classifies tracks as moving or static relative to the camera's motion.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/history.h"

namespace alidade {

// One vote per track: -1 moving, 1 static, 0 undecided. Compares the track with a frame up to half
// a second ago, to have parallax. `T_camera_world`: pose of the current frame. The point must lie
// on a segment of its epipolar line: at the measured depth of the earlier frame if known, else at
// any depth above `nearest` (meters or map units).
std::vector<int8_t> VoteByPose(const Camera& camera, const Cells& cells,
                               std::span<const FlowTrack> tracks, const Se3& T_camera_world,
                               const History& history, double nearest,
                               const FlowVoteSettings& settings = {});

// The same without a pose, by the epipolar geometry that most tracks agree on, or by the homography
// for a pure rotation. All votes are 0 when too few agree. `left_out`: tracks (nonzero) to ignore.
std::vector<int8_t> VoteByAgreement(const Camera& camera, std::span<const FlowTrack> tracks,
                                    std::span<const uint8_t> left_out, uint64_t seed,
                                    const FlowVoteSettings& settings = {});

// Share of the image, by area, that agrees on a competing motion, relative to this area plus the
// area that is static by `votes` (from Consensus()), 0…1. A value above one half indicates that the
// poses follow a moving object: several objects have different motions, but the static scene has
// one. 0 when too little is classified.
double ShareOfRivalMotion(const Camera& camera, const Cells& cells,
                          std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                          uint64_t seed, const FlowVoteSettings& settings = {});

// Replaces each vote by that of the surrounding tracks, when most agree, because single tracks
// drift. `depth`: of each cell, or empty; with depth only tracks on the same surface count.
std::vector<int8_t> Consensus(const Cells& cells, std::span<const float> depth,
                              std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                              const FlowVoteSettings& settings = {},
                              const CellDepthSettings& depth_settings = {});

}  // namespace alidade
