// A virtual cube on a tapped surface. It is anchored to the keyframe it was placed from, so that it moves with map
// corrections.
import type { Camera, Culled, Message, Pose, State } from '@alidade/scene';
import { compose, inverse, rotate, transform } from '../../scene/src/pose.ts'; // directly, because the package's scene requires a browser
import { project, unproject } from './lens.ts';
import type { Point, Ray } from './lens.ts';
import { visible } from './visible.ts';
import type { Seen } from './visible.ts';

type Vector = readonly [number, number, number];

// Parameters of the surface estimate from the map points around a tap.
// Share of the image width: points within this radius are used; if fewer than ENOUGH, the radius grows up to FARTHEST.
const REACH = 0.06;
const FARTHEST = 0.15;
const ENOUGH = 8; // number of points
// Share of the image width: if no point is this near, the points must surround the tap, to prevent extrapolation.
const NEAR = 0.03;
const WIDEST = 150; // degrees: largest gap in direction between points that surround the tap
const FLAT = 0.02; // share of the depth: distance of inliers to the plane
const TRIES = 200; // RANSAC iterations with three points each
const STEEPEST = 0.2; // cosine between surface normal and viewing ray; surfaces at grazing angles are rejected
const EDGE = 0.12; // share of the depth: edge length of the cube

const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const plus = (a: Vector, b: Vector, s = 1): Vector => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a: Vector, s: number): Vector => [s * a[0], s * a[1], s * a[2]];
const unit = (a: Vector): Vector => scaled(a, 1 / Math.hypot(...a));

export class Cube {
  private constructor(
    private keyframe: number,
    private at: Vector, // center of the base, in the keyframe (with lengths scaled as if its scale were 1)
    private axes: readonly [Vector, Vector, Vector], // edges in the keyframe; the last one is the surface normal
  ) {}

  // Places a cube on the surface at `tap` (pixels of the stream's camera); null: no map points near it.
  static place(state: State, tap: Point): Cube | null {
    const camera = state.hello?.camera;
    const T_world_camera = state.cameraPose();
    if (!camera || !T_world_camera) return null;
    const surface = surfaceAt(visible(state, camera, T_world_camera), camera, tap);
    if (!surface) return null;
    const keyframe = nearestKeyframe(state, T_world_camera);
    if (keyframe === null) return null;
    const { T_world_camera: T_world_keyframe, scale } = state.keyframes.get(keyframe)!;
    const T_keyframe_camera = compose(inverse(T_world_keyframe), 1, T_world_camera);
    const turn = (v: Vector): Vector => scaled(rotate(T_keyframe_camera, ...v), 1 / scale);
    const up = surface.normal;
    const side = unit(cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1]));
    const edge = EDGE * surface.at[2];
    return new Cube(keyframe, scaled(transform(T_keyframe_camera, 1, ...surface.at), 1 / scale),
      [turn(scaled(side, edge)), turn(scaled(cross(up, side), edge)), turn(scaled(up, edge))]);
  }

  // Call before the state applies the message: re-anchors the cube when its keyframe is culled.
  follow(message: Message): void {
    if (message.kind !== 'map') return;
    for (let moved = true; moved;) {
      moved = false;
      for (const culled of message.culled) {
        if (culled.id !== this.keyframe) continue;
        this.hangOn(culled);
        moved = true;
        break;
      }
    }
  }

  // Center of its base in the world; null: its keyframe was removed without a replacement.
  position(state: State): Vector | null {
    const keyframe = state.keyframes.get(this.keyframe);
    return keyframe ? transform(keyframe.T_world_camera, keyframe.scale, ...this.at) : null;
  }

  // Faces to draw, back to front: corners in pixels of the stream's camera, and brightness (0…1). `edge`: its length in
  // map units; null: as placed, a share of the depth.
  faces(state: State, T_world_camera: Pose, edge: number | null = null): { corners: Point[]; light: number }[] {
    const keyframe = state.keyframes.get(this.keyframe);
    const camera = state.hello?.camera;
    if (!keyframe || !camera) return [];
    const T_camera_keyframe = compose(inverse(T_world_camera), 1, keyframe.T_world_camera);
    const growth = edge === null ? 1 : edge / (keyframe.scale * Math.hypot(...this.axes[0]));
    const corner = (x: number, y: number, z: number): Vector => {
      const [a, b, c] = this.axes.map((axis) => scaled(axis, growth)) as [Vector, Vector, Vector];
      return transform(T_camera_keyframe, keyframe.scale, ...plus(plus(plus(this.at, a, x), b, y), c, z));
    };
    const sides: readonly [light: number, ...corners: Vector[]][] = [
      [0.35, corner(-.5, -.5, 0), corner(.5, -.5, 0), corner(.5, .5, 0), corner(-.5, .5, 0)],
      [1, corner(-.5, -.5, 1), corner(.5, -.5, 1), corner(.5, .5, 1), corner(-.5, .5, 1)],
      [0.85, corner(-.5, -.5, 0), corner(.5, -.5, 0), corner(.5, -.5, 1), corner(-.5, -.5, 1)],
      [0.6, corner(-.5, .5, 0), corner(.5, .5, 0), corner(.5, .5, 1), corner(-.5, .5, 1)],
      [0.75, corner(-.5, -.5, 0), corner(-.5, .5, 0), corner(-.5, .5, 1), corner(-.5, -.5, 1)],
      [0.7, corner(.5, -.5, 0), corner(.5, .5, 0), corner(.5, .5, 1), corner(.5, -.5, 1)],
    ];
    const far = (points: readonly Vector[]) => points.reduce((sum, p) => sum + Math.hypot(...p), 0);
    return sides.map(([light, ...points]) => ({ light, far: far(points), pixels: points.map((p) => project(camera, p)) }))
      .filter(({ pixels }) => pixels.every((pixel) => pixel !== null))
      .sort((a, b) => b.far - a.far)
      .map(({ light, pixels }) => ({ light, corners: pixels as Point[] }));
  }

  private hangOn({ follows, scale, T_follows_culled }: Culled): void {
    this.keyframe = follows;
    this.at = transform(T_follows_culled, scale, ...this.at);
    const turn = (v: Vector): Vector => scaled(rotate(T_follows_culled, ...v), scale);
    this.axes = [turn(this.axes[0]), turn(this.axes[1]), turn(this.axes[2])];
  }
}

interface Surface { at: Vector; normal: Vector }

// Intersection of the tap's ray with the plane of most points around the tap; the normal faces the camera.
function surfaceAt(all: readonly Seen[], camera: Camera, tap: Point): Surface | null {
  const byDistance = all.map((seen) => ({ ...seen, off: Math.hypot(seen.pixel[0] - tap[0], seen.pixel[1] - tap[1]) }))
    .filter(({ off }) => off <= FARTHEST * camera.width).sort((a, b) => a.off - b.off);
  if (byDistance.length < 3) return null;
  const near = byDistance.filter(({ off }, i) => i < ENOUGH || off <= REACH * camera.width);
  if (near[0]!.off > NEAR * camera.width && !surrounded(near.map(({ pixel }) => pixel), tap)) return null;
  const ray = unproject(camera, tap) as Ray;
  const depth = median(near.slice(0, 5).map(({ p }) => p[2]));
  const plane = planeOf(near.map(({ p }) => p), FLAT * depth);
  const towards = unit(scaled(ray, -1));
  if (plane) {
    const facing = dot(plane.normal, towards) < 0 ? scaled(plane.normal, -1) : plane.normal;
    const z = dot(plane.normal, plane.through) / dot(plane.normal, ray);
    if (dot(facing, towards) > STEEPEST && z > 0.5 * depth && z < 2 * depth) return { at: scaled(ray, z), normal: facing };
  }
  return { at: scaled(ray, depth), normal: towards };
}

function surrounded(pixels: readonly Point[], [x, y]: Point): boolean {
  const angles = pixels.map(([u, v]) => (Math.atan2(v - y, u - x) * 180) / Math.PI).sort((a, b) => a - b);
  return angles.every((angle, i) => (i + 1 < angles.length ? angles[i + 1]! : angles[0]! + 360) - angle <= WIDEST);
}

// RANSAC with three points, then least squares over the inliers: the normal is the direction of least spread. Null: no
// majority.
function planeOf(points: readonly Vector[], bound: number): { through: Vector; normal: Vector } | null {
  let best: Vector[] = [];
  let seed = 1;
  const pick = () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return points[Math.floor((seed / 2 ** 32) * points.length)]!;
  };
  for (let i = 0; i < TRIES; ++i) {
    const [a, b, c] = [pick(), pick(), pick()];
    const across = cross(minus(b, a), minus(c, a));
    if (Math.hypot(...across) < 1e-3 * bound * bound) continue;
    const normal = unit(across);
    const on = points.filter((p) => Math.abs(dot(normal, minus(p, a))) <= bound);
    if (on.length > best.length) best = on;
  }
  if (best.length < 6 || best.length < 0.5 * points.length) return null;
  const through = scaled(best.reduce((sum, p) => plus(sum, p), [0, 0, 0] as Vector), 1 / best.length);
  // Inverse power iteration on the scatter matrix, regularized by a small multiple of its trace.
  const m = [0, 0, 0, 0, 0, 0, 0, 0, 0];
  for (const p of best) {
    const d = minus(p, through);
    for (let r = 0; r < 3; ++r) for (let c = 0; c < 3; ++c) m[3 * r + c]! += d[r]! * d[c]!;
  }
  const trace = m[0]! + m[4]! + m[8]!;
  for (const k of [0, 4, 8]) m[k]! += 1e-6 * trace;
  const row = (r: number): Vector => [m[3 * r]!, m[3 * r + 1]!, m[3 * r + 2]!];
  const [a, b, c] = [row(0), row(1), row(2)];
  // Adj(M) v for symmetric M.
  const solve = (v: Vector): Vector => plus(plus(scaled(cross(b, c), v[0]), cross(c, a), v[1]), cross(a, b), v[2]);
  let normal: Vector = unit([0.3, 0.5, 0.8]);
  for (let i = 0; i < 30; ++i) normal = unit(solve(normal));
  return { through, normal };
}

function nearestKeyframe(state: State, T_world_camera: Pose): number | null {
  const map = state.activeMap;
  let best: number | null = null;
  let least = Infinity;
  for (const { id, map: of, T_world_camera: T } of state.keyframes.values()) {
    const off = Math.hypot(T[4]! - T_world_camera[4]!, T[5]! - T_world_camera[5]!, T[6]! - T_world_camera[6]!);
    if (of === map && off < least) [best, least] = [id, off];
  }
  return best;
}

function median(values: readonly number[]): number {
  return [...values].sort((a, b) => a - b)[values.length >> 1]!;
}
