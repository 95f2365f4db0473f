// The landmarks that the latest frame sees, in the camera's frame.
import type { Camera, Pose, State } from '@alidade/scene';
import { USES } from '../../scene/src/messages.ts';
import { compose, inverse, transform } from '../../scene/src/pose.ts'; // directly, because the package's scene requires a browser
import type { Vector } from '../../scene/src/pose.ts';
import { project } from './lens.ts';
import type { Point } from './lens.ts';

const SAME = 3; // pixels from a landmark to its feature

export interface Seen { id: number; p: Vector; pixel: Point }

// Those with a feature of the latest frame at their projection. Others may be occluded.
export function visible(state: State, camera: Camera, T_world_camera: Pose): Seen[] {
  const T_camera_world = inverse(T_world_camera);
  const map = state.activeMap;
  const seen: Seen[] = [];
  const features = matchedFeatures(state, camera);
  const from = new Map<number, { T: Pose; scale: number }>();
  for (const { id, map: of, T_world_camera: T, scale } of state.keyframes.values()) if (of === map) from.set(id, { T: compose(T_camera_world, 1, T), scale });
  for (let i = 0; i < state.landmarks.size; ++i) {
    const { id, keyframe, p } = state.landmarks.at(i);
    const pose = from.get(keyframe);
    if (!pose) continue;
    const there = transform(pose.T, pose.scale, ...p);
    const pixel = project(camera, there);
    if (pixel && features.some(([x, y]) => Math.abs(x - pixel[0]) < SAME && Math.abs(y - pixel[1]) < SAME)) seen.push({ id, p: there, pixel });
  }
  return seen;
}

function matchedFeatures(state: State, camera: Camera): Point[] {
  const packed = state.frame?.features;
  const points: Point[] = [];
  if (!packed) return points;
  const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
  for (let at = 0; at + 6 <= packed.length; at += 6) {
    if (USES[packed[at + 4]!] !== 'matched' && USES[packed[at + 4]!] !== 'fresh') continue;
    points.push([(view.getUint16(at, true) * camera.width) / 65536 - 0.5, (view.getUint16(at + 2, true) * camera.height) / 65536 - 0.5]);
  }
  return points;
}
