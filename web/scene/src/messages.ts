// Messages of the stream as plain values. Names, units and frames are those of src/alidade/stream/stream.fbs.

import type { Failure } from './failures.ts';

export type { Failure };

export const NONE = 0xffffffff; // the invalid id

export type Pose = readonly number[]; // qx qy qz qw tx ty tz; T_a_b maps points of b into a

export const STATES = ['initializing', 'tracking', 'lost'] as const;
export type TrackingState = (typeof STATES)[number];

export const USES = ['free', 'matched', 'fresh', 'moving'] as const;

export const EVENT_KINDS = [
  'waiting', 'started', 'lost', 'found', 'loop', 'merge', 'new_map', 'given_up', 'cut', 'warning', 'finished',
] as const;
export type EventKind = (typeof EVENT_KINDS)[number];

export const STAGES = ['frame', 'extract', 'track', 'map', 'loop', 'semidense', 'detect', 'dynamics'] as const;

export interface Camera {
  width: number; height: number; // pixels
  fx: number; fy: number; cx: number; cy: number;
  distortion: number[]; // k1 k2 p1 p2 k3
  baseline: number; // meters; 0: monocular
}

export interface TruePose { time: number; T_world_camera: Pose }

export interface Hello {
  kind: 'hello';
  version: number;
  program: string; source: string; sensor: string; unit: string;
  frames: number; // -1: unknown
  live: boolean;
  camera: Camera | null;
  truth: TruePose[];
}

// Pixels, from edge to edge: the first pixel covers 0 to 1.
export interface Detection { x: number; y: number; width: number; height: number; score: number; label: string }
export interface Picture { width: number; height: number; type: string; bytes: Uint8Array<ArrayBuffer> }

export interface Frame {
  kind: 'frame';
  number: number; time: number;
  state: TrackingState; cut: string;
  failure: Failure | null; // why there is no pose; null: tracking, or unknown
  reason: string; // in words
  predicted: boolean; // lost; T_world_camera is extrapolated from the last motion
  keyframe: boolean;
  reference: number; map: number;
  T_reference_camera: Pose | null; T_world_camera: Pose | null;
  keyframes: number; landmarks: number; matches: number; maps: number;
  foundShare: number;
  ms: number[]; // per STAGES; -1: did not run
  features: Uint8Array; // 6 bytes each: x u16, y u16, use u8, static probability u8
  detections: Detection[];
  detectionAge: number; // seconds from the frame of the detections to this one; negative: no result yet
  outlines: Uint16Array[]; // x, y, x, y, … of a closed polygon
  picture: Picture | null;
}

export interface KeyFrame {
  id: number; map: number; parent: number;
  number: number; time: number;
  T_world_camera: Pose; scale: number;
  covisible: number[]; loops: number[];
}
export interface Move { id: number; scale: number; T_world_camera: Pose }
export interface Culled { id: number; follows: number; scale: number; T_follows_culled: Pose }
export interface DepthCloud {
  keyframe: number;
  least: number; most: number; // inverse depth
  points: Uint16Array; // 4 per point: x, y, depth, color (rgb 565)
}
export interface PathFrame { number: number; time: number; state: TrackingState; reference: number; T_reference_camera: Pose }

// What an inertial sensor or a survey tells of a map.
export interface World {
  map: number;
  meters: boolean; // lengths are meters, whatever the unit of Hello
  scaleSigma: number; // relative standard deviation of lengths; 0: unknown
  down: readonly [number, number, number] | null; // direction in which things fall, in the world; null: unknown
  downSigma: number; // its standard deviation, radians; 0: unknown
}

export interface MapChange {
  kind: 'map';
  version: bigint;
  whole: boolean;
  keyframes: KeyFrame[];
  moves: Move[];
  landmarks: DataView; // 20 bytes each: id u32, keyframe u32, x y z f32
  removedLandmarks: Uint32Array;
  culled: Culled[];
  depth: DepthCloud[];
  path: PathFrame[];
  worlds: World[] | null; // of all maps of which something is known; null: as before
}

export interface Event {
  kind: 'event';
  what: EventKind; number: number; time: number; text: string;
  a: number; b: number;
}

export interface Playback { kind: 'playback'; paused: boolean; finished: boolean; mayPause: boolean }

export type Message = Hello | Frame | MapChange | Event | Playback;
