// Thresholds of the parts that separate moving objects from the static scene. Belief is the
// log-odds of being static, l = ln(p / (1 - p)): independent evidence adds up, 0 is even, 1.5 is p
// = 0.82 and -0.85 is p = 0.3. "Per frame" refers to 30 frames per second.
#pragma once

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Depth of cells, and its comparison with other views. dynamics.depth
struct CellDepthSettings {
  int min_readings = 3;  // of nine per cell; fewer may all be noise
  // Relative to the depth: neighboring cells that differ by more are on two surfaces. Twice the
  // step on a wall seen at 60 degrees.
  float surface_step = 0.06f;
  // Belief spreads from a cell to its neighbor with weight 1 - (step / (spread_step × depth))², and
  // 0 beyond; with weight spread_unmeasured if one of them has no depth.
  float spread_step = 0.05f;       // share of the depth
  float spread_unmeasured = 0.2f;  // 0…1
  // Two depths z are of one surface if they differ by at most a + b z + c z². Noise of sensors that
  // measure disparity grows as z² (Khoshelham & Elberink 2012), errors of poses as z.
  float tolerance = 0.04f;          // a, meters
  float tolerance_linear = 0.02f;   // b
  float tolerance_square = 0.004f;  // c, 1/meters
  // Free space: an earlier view saw through a point if its depth there is larger by this many
  // tolerances …
  float free_tolerances = 2;
  int free_neighbours = 5;  // … and if this many of the nine cells around have depth
  // Block matching of a stereo pair, at half size (Konolige 1998).
  double stereo_nearest = 0.5;  // meters: limits the disparity that is searched
  int stereo_window = 15;       // pixels, odd: smaller is noisier, larger widens outlines
  int stereo_texture = 10;      // least sum of gradients in the window for a match
  int stereo_uniqueness = 12;   // per cent by which the best match must exceed the second
  void Check() const;           // throws Error (usage) naming the invalid field
};

// Earlier frames that are stored for comparison. dynamics.history
struct HistorySettings {
  int recent = 32;  // consecutive frames: the length of tracks
  int step = 10;    // frames from one older view to the next
  int older = 9;    // older views: three seconds, 38 KB each
  void Check() const;
};

// Classification of flow tracks as moving or static. dynamics.votes
struct FlowVoteSettings {
  int least_ago = 2;  // frames back to which a track is compared: fewer give no parallax …
  int most_ago = 15;  // … more (half a second) lets the flow drift
  // A track moves if its distance from the admissible segment of its epipolar line exceeds px +
  // share × (its length in pixels), and is static below half of that: errors of the pose, and of a
  // measured depth (which limits the segment), grow with the length.
  double moved_px = 1.5, moved_share = 0.05;
  double measured_px = 3, measured_share = 0.15;  // with measured depth
  double depth_noise = 0.03;  // relative to the depth: margin at both ends of the measured range
  // Single tracks may slip, so the mean vote (-1 … 1) of the tracks on the same surface around
  // decides.
  int consensus_reach = 3;   // cells
  int consensus_tracks = 3;  // with fewer there is no result
  float consensus = 0.4f;    // mean vote: more than 70 % against 30 %
  // Without a pose: the epipolar geometry, or homography, that most tracks agree on.
  int agreement_ago = 10;  // frames between both images
  // of RANSAC: with 60 % inliers, 8 inliers are drawn with a probability of 80 %
  int agreement_iterations = 100;
  int agreement_tracks = 40;     // with fewer there is no result
  double agreement_share = 0.5;  // least share of inliers
  double agreement_sigma = 1.5;  // pixels, standard deviation
  // relative to the inliers of the epipolar geometry: pure rotation
  double homography_share = 0.85;
  // A map of a moving object: in more than rival_share of the classified image blocks the tracks
  // agree on another motion than that of the poses, in rival_frames frames more than not.
  int rival_block = 4;        // cells: a near person has many corners, the room is wide
  int rival_blocks = 10;      // with fewer classified blocks there is no result
  double rival_share = 0.55;  // moving objects have different motions, the room has one
  int rival_frames = 5;
  void Check() const;
};

// Belief of cells with measured depth. dynamics.surfaces
struct SurfaceBeliefSettings {
  float forget = 0.01f;    // relaxation to the unknown, per frame: 40 % remain after 3 s
  float remember = 0.95f;  // factor on the certainty of a cell, per frame
  float learn = 0.3f;      // certainty gained by evidence of weight 1: complete after four frames
  int gap = 5;             // frames without depth before belief is reset
  // A surface where an earlier view saw through has moved there; one that was there before, and was
  // not considered moving, is static. Log-odds per frame.
  float free = -1.5f;
  float same = 0.2f;
  int compare_near = 7, compare_far = 16;  // frames back, in addition to the older views
  // Evidence "same surface" has weight min(1, age / young) × static probability at that time, where
  // age is that of the view: recent views prove little.
  float young = 30;      // frames
  float settled = 75;    // frames after which a moving object that stays is considered at rest …
  float rested = 0.5f;   // … with this log-odds: otherwise it would be left out forever
  float trusted = 0.4f;  // weight of "same surface" from which "seen through" is ignored
  float confirmed = 0.06f;  // log-odds by depth in one frame that tracks cannot overrule
  // Evidence of each track in or next to the cell, log-odds per frame.
  float flow_moved = -0.5f;
  float flow_stood = 0.02f;  // small: a moving person may also rest for a moment
  // weight of static evidence in certainty; that of moving evidence is 1
  float flow_stood_weight = 0.2f;
  // A cell approaches the belief of its surface: per frame it moves by spread_rate × (1 - c) ×
  // min(1, spread_heard × W), W = Σ k c², of the way to Σ k c² l / Σ k c², where c is certainty
  // (0…1), l log-odds, and the kernel k decreases by spread_fade per cell and does not cross depth
  // steps (SpreadOverSurfaces).
  float spread_fade = 0.75f;
  float spread_rate = 0.3f;
  float spread_heard = 20;
  float spread_least = -0.5f;  // log-odds: lower only where a detector sees a person
  void Check() const;
};

// Belief of tracks without measured depth. dynamics.tracks
struct TrackBeliefSettings {
  float moved = -1.0f;  // log-odds, per frame
  float stood = 0.1f;   // small: a point moving along its epipolar line looks static
  // Bounds, added to the prior 1.5: a point that was static for long is left out after five frames
  // of motion, one that moved for long is used again after a second at rest.
  float least = -6;
  float most = 3;
  float forget = 0.01f;  // relaxation to the unknown, per frame
  float proven = 1.5f;   // from here on it is certainly static: half a second of votes
  float fade = 0.35f;  // share that passes from cell to cell, since without depth nothing limits it
  void Check() const;
};

// Propagation of detected objects. dynamics.objects
struct ObjectSettings {
  float same_overlap = 0.3f;  // intersection over union from which a detection is of a known object
  int flow_tracks = 4;        // least number of tracks whose median gives the motion of an object
  float flow_middle = 0.6f;   // share of its box used in each direction if its mask is unknown
  // Whether an object rests, from the votes of its tracks. Log-odds per frame.
  int rest_tracks = 6;  // with fewer votes there is no result
  // shares of the votes above which it moves, or rests
  double moves_share = 0.15, rests_share = 0.7;
  float moved = -1;
  float rested = 0.07f;        // 1.5 s from -4 to the maximum, -0.85
  double carried_share = 0.4;  // share of its cells that move: a carried object moves as a whole
  void Check() const;
};

// Which part of a detection's box is the object. dynamics.box
struct BoxSettings {
  float widen = 0.06f;  // share of the box's size on every side: boxes cut off hands and feet
  // Depth of the object: the most frequent one in the box's inner ellipse (u² + v² < 1).
  // relative to that depth: surfaces farther away or closer are other objects …
  float reach = 0.22f;
  float min_reach = 0.45f;   // … but at least this many meters belong to the object: an arm
  float seed = 0.06f;        // relative to that depth: cells this close to it …
  float seed_middle = 0.5f;  // … and within this u² + v² start the surface …
  float step = 0.04f;  // … which grows over relative depth steps of this size from cell to cell
  float known_static = 3.5f;  // log-odds (p = 0.97): not the object, such as the floor …
  float middle = 0.3f;        // … unless, of the cells within this u² + v² …
  // … more than this share is known to be static: a person who stood there
  float most_still = 0.7f;
  // Parts behind an occlusion, such as legs behind a chair's back, are added within this range
  // around the object's depth (relative to it).
  float island_before = 0.06f, island_behind = 0.3f;
  // Without depth, |u|^e + |v|^e < 1: between an ellipse (2) and the box.
  float oval = 2.6f;
  float rim = 0.4f;  // beyond this value, certainly static cells are background
  void Check() const;
};

// Weights of features by their cells. dynamics.features
struct FeatureBeliefSettings {
  // Static probability from which a feature has full weight: slightly below the prior 0.82.
  float sure = 0.8f;
  // A feature gets the belief of the cell around it whose depth is closest.
  float surface = 0.08f;  // relative to the depth: cells within it are of the same surface
  int far_cells = 6;      // search distance if the cells around are of other surfaces
  int reading_reach = 2;  // pixels to the nearest depth reading if the feature has none
  // If fewer than enough_share of all features are certain, or fewer than enough_count (at most
  // half of all), the other features have at least uncertain_weight in the pose, except those seen
  // to move.
  float enough_share = 0.15f;
  float enough_count = 120;
  float uncertain_weight = 0.15f;
  void Check() const;
};

// Evidence of a frame for a landmark that should be visible: log-odds per frame. dynamics.landmarks
struct LandmarkEvidenceSettings {
  int min_neighbours = 5;      // of nine cells must have depth for "gone"
  float on_mover = -0.4f;      // it is at the depth of a moving object
  float gone = -0.7f;          // not found, and the depth there is larger
  float hidden_found = -0.3f;  // found, although a possibly moving object is in front of it
  float found = 0.15f;         // small: most are found in hundreds of frames
  // of all expected landmarks: if more are on moving objects, the segmentation is not trusted
  double most_on_movers = 0.5;
  void Check() const;
};

}  // namespace alidade
