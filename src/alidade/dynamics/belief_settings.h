// Thresholds of the parts that tell movers from what stands still. Belief is in log-odds of
// standing still, l = ln(p / (1 - p)): independent evidence adds up, 0 is even, 1.5 is p = 0.82
// and -0.85 is p = 0.3. "Per frame" is at 30 frames per second.
#pragma once

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Depth of cells, and of one view against another. dynamics.depth
struct CellDepthSettings {
  int min_readings = 3;  // of the nine read in a cell: fewer may all be noise
  // Share of the depth: neighbours farther apart are on two surfaces. Twice what a wall at 60
  // degrees has from one cell to the next.
  float surface_step = 0.06f;
  // What is known of a cell passes to its neighbour by 1 - (step / (spread_step × depth))²,
  // nothing beyond; by spread_unmeasured where one of them has no depth.
  float spread_step = 0.05f;       // share of the depth
  float spread_unmeasured = 0.2f;  // 0…1
  // Two depths are of one surface when they differ by no more than a + b z + c z². Noise of
  // sensors that measure disparity grows as z² (Khoshelham & Elberink 2012), errors of poses as z.
  float tolerance = 0.04f;          // a, metres
  float tolerance_linear = 0.02f;   // b
  float tolerance_square = 0.004f;  // c, 1/metres
  // A place was looked through when what was seen there is so many tolerances behind it …
  float free_tolerances = 2;
  int free_neighbours = 5;  // … and so many of the nine cells around had depth
  // Block matching of a stereo pair, at half size (Konolige 1998).
  double stereo_nearest = 0.5;  // metres: what is nearer has no match. Sets how far is searched
  int stereo_window = 15;       // pixels, odd: less is noisy, more widens outlines
  int stereo_texture = 10;      // sum of gradients in the window, below it there is no match
  int stereo_uniqueness = 12;   // per cent: how much better the best must be than the second
  void Check() const;           // throws Error (usage) naming the field that cannot be
};

// Earlier frames that are kept to compare with. dynamics.history
struct HistorySettings {
  int recent = 32;  // frames kept one by one: as long as tracks remember
  int step = 10;    // frames from one older view to the next
  int older = 9;    // older views: three seconds, 38 KB each
  void Check() const;
};

// Which flow tracks moved. dynamics.votes
struct FlowVoteSettings {
  int least_ago = 2;  // frames back a track is held against: nearer there is no parallax …
  int most_ago = 15;  // … farther, half a second, flow has drifted
  // It moved when it is farther than px + share × (pixels it went) from the piece of its epipolar
  // line where it may be, and stood still when by less than half of that: errors of the pose, and
  // of measured depth (which cuts the piece short), grow with the way.
  double moved_px = 1.5, moved_share = 0.05;
  double measured_px = 3, measured_share = 0.15;  // where the depth was measured
  double depth_noise = 0.03;  // share of the depth, added at both ends of what was measured around
  // One track may slip, a surface has several: it moves or stands when the mean vote (-1 … 1) of
  // the tracks on the same surface around is beyond so much.
  int consensus_reach = 3;   // cells
  int consensus_tracks = 3;  // with fewer nothing is told
  float consensus = 0.4f;    // mean vote: more than 70 % against 30 %
  // Without a pose: the epipolar geometry, or homography, that most tracks agree on.
  int agreement_ago = 10;          // frames back
  int agreement_iterations = 100;  // of RANSAC: where 60 % agree, 8 of them are met by 80 %
  int agreement_tracks = 40;       // with fewer nothing is told
  double agreement_share = 0.5;    // of the tracks must agree
  double agreement_sigma = 1.5;    // pixels, standard deviation
  double homography_share = 0.85;  // of the other's inliers: the camera only turned
  // A map of something that moves: in more than rival_share of the picture's blocks that tell, the
  // tracks agree on another motion than that of the poses, for so many frames more than not.
  int rival_block = 4;        // cells: someone near has many corners, the room is wide
  int rival_blocks = 10;      // with fewer that tell nothing is told
  double rival_share = 0.55;  // movers have a motion each, the room has one
  int rival_frames = 5;
  void Check() const;
};

// Belief of cells where depth is measured. dynamics.surfaces
struct SurfaceBeliefSettings {
  float forget = 0.01f;  // share of the way back to the unknown, per frame: 40 % are left after 3 s
  float remember = 0.95f;  // share of its certainty that a cell keeps, per frame
  float learn = 0.3f;      // certainty gained by evidence of weight 1: full after four frames
  int gap = 5;             // frames that may come without depth before belief is lost
  // What stands where an earlier view looked through has come since; what was there before and
  // was not thought to move stands still. Log-odds per frame.
  float free = -1.5f;
  float same = 0.2f;
  int compare_near = 7, compare_far = 16;  // frames back, besides the older views
  // "The same" counts by min(1, age / young) × probability that it stood still then, age being
  // that of the view: what came a moment ago proves nothing.
  float young = 30;         // frames
  float settled = 75;       // frames after which a mover that stays has come to rest …
  float rested = 0.5f;      // … with so much probability: else it would be left out for ever
  float trusted = 0.4f;     // weight of "the same" from which "looked through" is not believed
  float confirmed = 0.06f;  // log-odds of the frame's depth that tracks cannot overrule
  // Of each track on the cell or beside it, log-odds per frame.
  float flow_moved = -0.5f;
  float flow_stood = 0.02f;        // little: whoever rests for a moment stands still, too
  float flow_stood_weight = 0.2f;  // of its evidence in certainty; "moved" has 1
  // A cell takes after its surface: per frame it goes, by
  //   spread_rate × (1 - c) × min(1, spread_heard × W), W = Σ k c²
  // of the way to Σ k c² l / Σ k c², where c is certainty (0…1), l log-odds, and the kernel k fades
  // by spread_fade from cell to cell and does not cross steps of depth (SpreadOverSurfaces).
  float spread_fade = 0.75f;
  float spread_rate = 0.3f;
  float spread_heard = 20;
  float spread_least = -0.5f;  // log-odds: lower only where a detector sees someone
  void Check() const;
};

// Belief of tracks where no depth is measured. dynamics.tracks
struct TrackBeliefSettings {
  float moved = -1.0f;  // log-odds, per frame
  float stood = 0.1f;   // little, as what moves along its epipolar line seems to stand
  // Bounds, added to the unknown's 1.5: what has long stood is left out after five frames of
  // motion, what has long moved is used again after a second of standing.
  float least = -6;
  float most = 3;
  float forget = 0.01f;  // share of the way back to the unknown, per frame
  float proven = 1.5f;   // from there it stands still for certain: half a second of votes
  float fade = 0.35f;    // share that passes from cell to cell: without depth nothing stops it
  void Check() const;
};

// What a detector has found, carried on. dynamics.objects
struct ObjectSettings {
  float same_overlap = 0.3f;  // intersection over union from which a detection is of a known object
  int flow_tracks = 4;        // so many on an object tell by their median how it moved
  float flow_middle = 0.6f;   // of its box, each way, when it is not known what it covers
  // An object rests, or not, by the votes of the tracks on it. Log-odds per frame.
  int rest_tracks = 6;                           // with fewer votes nothing is told
  double moves_share = 0.15, rests_share = 0.7;  // of the votes, from which it moves, or rests
  float moved = -1;
  float rested = 0.07f;        // 1.5 s from -4 to the most there is, -0.85
  double carried_share = 0.4;  // of its cells seen to move: a carried thing moves as a whole
  void Check() const;
};

// What of a detection's box is the thing itself. dynamics.box
struct BoxSettings {
  float widen = 0.06f;  // of the box's size, on every side: boxes cut off hands and feet
  // Depth of the thing: the most frequent of the box's inner ellipse, (u² + v² < 1).
  float reach = 0.22f;      // of that depth: what is farther before or behind is something else …
  float min_reach = 0.45f;  // … but so many metres are the thing's in any case: an arm
  float seed = 0.06f;       // of that depth: so near it …
  float seed_middle = 0.5f;   // … within u² + v² of so much, the surface begins to grow …
  float step = 0.04f;         // … over steps of this share of the depth, from cell to cell
  float known_static = 3.5f;  // log-odds (p = 0.97): not the thing, such as the floor …
  float middle = 0.3f;        // … but where of the cells within u² + v² of so much
  float most_still = 0.7f;    // more than this share is known to be static: someone who stood there
  // Parts that something else cuts off, such as legs by a chair's back, are taken from so far
  // before to so far behind the thing's depth (shares of it).
  float island_before = 0.06f, island_behind = 0.3f;
  // Without depth, |u|^e + |v|^e < 1: between an ellipse (2) and the box.
  float oval = 2.6f;
  float rim = 0.4f;  // beyond this value of it, what stands still for certain is background
  void Check() const;
};

// What features are worth by the cells they are in. dynamics.features
struct FeatureBeliefSettings {
  // Probability from which a feature counts fully: a little below 0.82, that of the unknown.
  float sure = 0.8f;
  // A feature takes after the cell around it that is nearest to it in depth.
  float surface = 0.08f;  // share of the depth within which a cell shows its surface
  int far_cells = 6;      // so far it is looked for, where those around show something else
  int reading_reach = 2;  // pixels to the next reading, when it has no depth of its own
  // When fewer than enough_share of all features are certain, or fewer than enough_count (half of
  // all, if those are less), the others have at least uncertain_weight in the pose, but for those
  // on what was seen to move.
  float enough_share = 0.15f;
  float enough_count = 120;
  float uncertain_weight = 0.15f;
  void Check() const;
};

// What a frame says of a landmark that should be seen: log-odds per frame. dynamics.landmarks
struct LandmarkEvidenceSettings {
  int min_neighbours = 5;       // of nine cells must have depth, else nothing is against seeing it
  float on_mover = -0.4f;       // it is at the depth of what moves there
  float gone = -0.7f;           // not found, and one sees through its place to what is behind
  float hidden_found = -0.3f;   // found, though something that may move is in front of its place
  float found = 0.15f;          // little: most are found in hundreds of frames
  double most_on_movers = 0.5;  // of all expected: more, and it is the movers that are not believed
  void Check() const;
};

}  // namespace alidade
