// Size of a map from a sample of it. Uses medians, because some landmarks are far off.
import { transform } from './pose.ts';
import type { State } from './state.ts';
import type { Extent } from './view.ts';

const SAMPLES = 400;

function median(values: number[]): number {
  return values.sort((a, b) => a - b)[values.length >> 1];
}

// Median distance of landmarks to their keyframes, world units; 1 without landmarks.
export function typicalDistance(state: State, map: number): number {
  const distances: number[] = [];
  const { landmarks } = state;
  const stride = Math.max(1, Math.floor(landmarks.size / SAMPLES));
  for (let i = 0; i < landmarks.size; i += stride) {
    const { keyframe, p } = landmarks.at(i);
    const of = state.keyframes.get(keyframe);
    const distance = of?.map === map ? of.scale * Math.hypot(...p) : NaN;
    if (Number.isFinite(distance)) distances.push(distance);
  }
  const result = distances.length > 0 ? median(distances) : 1;
  // Quantized to steps of 1/8 of a power of two, so that drawn sizes stay constant while the map grows.
  return result > 0 ? 2 ** (Math.round(8 * Math.log2(result)) / 8) : 1;
}

export function extentOf(state: State, map: number): Extent {
  const points: [number, number, number][] = [];
  for (const keyframe of state.keyframes.values()) {
    if (keyframe.map === map) points.push([keyframe.T_world_camera[4], keyframe.T_world_camera[5], keyframe.T_world_camera[6]]);
  }
  const cameras = points.length;
  const { landmarks } = state;
  const stride = Math.max(1, Math.floor(landmarks.size / SAMPLES));
  for (let i = 0; i < landmarks.size; i += stride) {
    const { keyframe, p } = landmarks.at(i);
    const of = state.keyframes.get(keyframe);
    const world = of?.map === map ? transform(of.T_world_camera, of.scale, ...p) : null;
    if (world?.every(Number.isFinite)) points.push(world);
  }
  if (points.length === 0) return { centre: [0, 0, 0], radius: 1 };
  const centre = [0, 1, 2].map((k) => median(points.map((p) => p[k]))) as [number, number, number];
  const away = (p: readonly number[]) => Math.hypot(p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]);
  const all = points.map(away).sort((a, b) => a - b);
  const radius = Math.max(all[Math.floor(0.9 * (all.length - 1))], ...points.slice(0, cameras).map(away));
  return { centre, radius: radius > 0 ? radius : 1 };
}
