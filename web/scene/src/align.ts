// Aligns the ground truth to a map by a similarity, or by a rigid motion where lengths are already in meters. Horn
// 1987, "Closed-form solution of absolute orientation using unit quaternions".
import type { Pose, TruePose } from './messages.ts';
import { NONE } from './messages.ts';
import { transform } from './pose.ts';
import type { State } from './state.ts';

const LATE = 0.02; // seconds, the largest difference between a frame and its true pose
const FEWEST = 3; // pairs

export interface Alignment {
  truth: number[][]; // positions in the map's world
  errors: Float64Array; // per frame of the path, meters (of the truth); NaN: unknown
  rmse: number; // meters
  worst: number;
}

export function alignTruth(state: State, map: number): Alignment | null {
  const { hello, path } = state;
  if (!hello || hello.truth.length === 0 || path.length === 0) return null;
  const pairs: { at: number; map: readonly number[]; truth: readonly number[] }[] = [];
  let next = 0;
  for (let at = 0; at < path.length; ++at) {
    const frame = path.at(at);
    const keyframe = frame.state === 'tracking' && frame.reference !== NONE ? state.keyframes.get(frame.reference) : undefined;
    if (keyframe?.map !== map || !keyframe) continue;
    while (next + 1 < hello.truth.length && Math.abs(hello.truth[next + 1].time - frame.time) <= Math.abs(hello.truth[next].time - frame.time)) ++next;
    if (Math.abs(hello.truth[next].time - frame.time) > LATE) continue;
    const t = frame.T_reference_camera;
    pairs.push({ at, map: transform(keyframe.T_world_camera, keyframe.scale, t[4], t[5], t[6]), truth: hello.truth[next].T_world_camera.slice(4) });
  }
  if (pairs.length < FEWEST) return null;
  const fit = similarity(pairs.map((pair) => pair.truth), pairs.map((pair) => pair.map), state.unit !== 'm');
  if (!fit) return null;
  const errors = new Float64Array(path.length).fill(NaN);
  let sum = 0;
  let worst = 0;
  for (const { at, map: p, truth } of pairs) {
    const q = transform(fit.T, fit.scale, truth[0], truth[1], truth[2]);
    errors[at] = Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) / fit.scale;
    sum += errors[at] ** 2;
    worst = Math.max(worst, errors[at]);
  }
  const truth = hello.truth.map((pose: TruePose) => transform(fit.T, fit.scale, pose.T_world_camera[4], pose.T_world_camera[5], pose.T_world_camera[6]));
  return { truth, errors, rmse: Math.sqrt(sum / pairs.length), worst };
}

// The similarity with b ≈ T (scale a). Null: all points of a coincide.
export function similarity(a: readonly (readonly number[])[], b: readonly (readonly number[])[], scaled: boolean): { T: Pose; scale: number } | null {
  const mean = (points: readonly (readonly number[])[]) => [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
  const [ma, mb] = [mean(a), mean(b)];
  const M = Array(9).fill(0) as number[]; // Σ a bᵀ
  let spread = 0;
  a.forEach((p, i) => {
    const x = p.map((value, k) => value - ma[k]);
    const y = b[i].map((value, k) => value - mb[k]);
    for (let r = 0; r < 3; ++r) for (let c = 0; c < 3; ++c) M[3 * r + c] += x[r] * y[c];
    spread += x[0] ** 2 + x[1] ** 2 + x[2] ** 2;
  });
  if (!(spread > 0)) return null;
  const [xx, xy, xz, yx, yy, yz, zx, zy, zz] = M;
  const q = greatestEigenvector([
    [xx + yy + zz, yz - zy, zx - xz, xy - yx],
    [yz - zy, xx - yy - zz, xy + yx, zx + xz],
    [zx - xz, xy + yx, yy - xx - zz, yz + zy],
    [xy - yx, zx + xz, yz + zy, zz - xx - yy],
  ]);
  const turn: Pose = [q[1], q[2], q[3], q[0], 0, 0, 0];
  let along = 0; // Σ b · R a
  a.forEach((p, i) => {
    const x = transform(turn, 1, p[0] - ma[0], p[1] - ma[1], p[2] - ma[2]);
    along += x[0] * (b[i][0] - mb[0]) + x[1] * (b[i][1] - mb[1]) + x[2] * (b[i][2] - mb[2]);
  });
  const scale = scaled ? along / spread : 1;
  if (!(scale > 0)) return null;
  const c = transform(turn, scale, ma[0], ma[1], ma[2]);
  return { T: [...turn.slice(0, 4), mb[0] - c[0], mb[1] - c[1], mb[2] - c[2]], scale };
}

// Eigenvector of the largest eigenvalue of a symmetric 4×4 matrix, by Jacobi rotations.
function greatestEigenvector(A: number[][]): number[] {
  const V: number[][] = [0, 1, 2, 3].map((r) => [0, 1, 2, 3].map((c) => Number(r === c)));
  for (let sweep = 0; sweep < 30; ++sweep) {
    let off = 0;
    for (let p = 0; p < 3; ++p) {
      for (let q = p + 1; q < 4; ++q) {
        off += A[p][q] ** 2;
        if (A[p][q] === 0) continue;
        const theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
        const t = Math.sign(theta || 1) / (Math.abs(theta) + Math.hypot(theta, 1));
        const c = 1 / Math.hypot(t, 1);
        const s = t * c;
        for (let k = 0; k < 4; ++k) [A[k][p], A[k][q]] = [c * A[k][p] - s * A[k][q], s * A[k][p] + c * A[k][q]];
        for (let k = 0; k < 4; ++k) [A[p][k], A[q][k]] = [c * A[p][k] - s * A[q][k], s * A[p][k] + c * A[q][k]];
        for (let k = 0; k < 4; ++k) [V[k][p], V[k][q]] = [c * V[k][p] - s * V[k][q], s * V[k][p] + c * V[k][q]];
      }
    }
    if (off < 1e-30 * (A[0][0] ** 2 + A[1][1] ** 2 + A[2][2] ** 2 + A[3][3] ** 2)) break;
  }
  const best = [0, 1, 2, 3].reduce((a, b) => (A[b][b] > A[a][a] ? b : a));
  return V.map((row) => row[best]);
}
