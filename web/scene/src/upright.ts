// Estimates the up direction of a world as src/alidade/view/upright.cc does, by power iteration.
import type { Pose } from './messages.ts';
import { rotate } from './pose.ts';
import type { Vector } from './pose.ts';

const OWN_WEIGHT = 0.02; // of the mean up axis, relative to 1 of the right axes; sin² of 8° of rotation

const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const times = (a: Vector, k: number): Vector => [a[0] * k, a[1] * k, a[2] * k];
const unit = (a: Vector): Vector => times(a, 1 / Math.hypot(...a));

export interface Upright { right: Vector; forward: Vector; up: Vector } // orthonormal, in the world

// `known`: up, if it is known.
export function upright(poses: Iterable<Pose>, known: Vector | null = null): Upright {
  let own: Vector = [0, 0, 0];
  const M = [0, 0, 0, 0, 0, 0, 0, 0, 0];
  let count = 0;
  let forward: Vector = [0, 0, 1];
  for (const T of poses) {
    if (count++ === 0) forward = rotate(T, 0, 0, 1);
    const down = rotate(T, 0, 1, 0);
    own = [own[0] - down[0], own[1] - down[1], own[2] - down[2]];
    const right = rotate(T, 1, 0, 0);
    for (let r = 0; r < 3; ++r) for (let c = 0; c < 3; ++c) M[3 * r + c] += right[r] * right[c];
  }
  let up: Vector = [0, -1, 0];
  if (count > 0 && Math.hypot(...own) > 1e-9) {
    own = unit(own);
    // Smallest eigenvector of M / count - weight own ownᵀ, as the largest one of the identity minus this matrix.
    const A = M.map((value, i) => (i % 4 === 0 ? 1 : 0) - value / count + OWN_WEIGHT * own[Math.floor(i / 3)] * own[i % 3]);
    up = own;
    for (let i = 0; i < 200; ++i) up = unit([0, 3, 6].map((r) => A[r] * up[0] + A[r + 1] * up[1] + A[r + 2] * up[2]) as unknown as Vector);
    if (dot(up, own) < 0) up = times(up, -1);
  }
  if (known) up = unit(known);
  const lean = dot(up, forward);
  forward = [forward[0] - lean * up[0], forward[1] - lean * up[1], forward[2] - lean * up[2]];
  if (Math.hypot(...forward) < 1e-3) forward = cross(up, Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1]);
  forward = unit(forward);
  return { right: cross(forward, up), forward, up };
}
