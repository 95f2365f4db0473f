// Which tracks move against the camera's own motion.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/history.h"

namespace alidade {

// For each track: -1 it moves, 1 it stands still, 0 that cannot be told. Held against a frame up to
// half a second ago, for parallax. `T_camera_world`: of the present frame. Where the depth of the
// earlier frame is known, it says where on the epipolar line the point must be; else anything
// farther than `nearest` (metres or map units) will do.
std::vector<int8_t> VoteByPose(const Camera& camera, const Cells& cells,
                               std::span<const FlowTrack> tracks, const Se3& T_camera_world,
                               const History& history, double nearest,
                               const FlowVoteSettings& settings = {});

// The same where no pose is known, by the epipolar geometry that most tracks agree on, or the
// homography when the camera only turned. All 0 when too few agree.
std::vector<int8_t> VoteByAgreement(const Camera& camera, std::span<const FlowTrack> tracks,
                                    std::span<const uint8_t> left_out, uint64_t seed,
                                    const FlowVoteSettings& settings = {});

// Of the picture, by area: the share that agrees on another motion, of that and what stands still
// by the votes of Consensus(), 0…1. Above one half the pose they were made by follows something
// that moves: movers have a motion each, the room has one. 0 when too little can be told.
double ShareOfRivalMotion(const Camera& camera, const Cells& cells,
                          std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                          uint64_t seed, const FlowVoteSettings& settings = {});

// One track may slip, a surface has several: the vote of those nearby, of like depth where it is
// known (one value for each cell, or none), when most agree.
std::vector<int8_t> Consensus(const Cells& cells, std::span<const float> depth,
                              std::span<const FlowTrack> tracks, std::span<const int8_t> votes,
                              const FlowVoteSettings& settings = {},
                              const CellDepthSettings& depth_settings = {});

}  // namespace alidade
