// Poses as qx qy qz qw tx ty tz, and similarities: a pose and a scale, p → R (scale p) + t.
import type { Pose } from './messages.ts';

export type Vector = readonly [number, number, number];

export const IDENTITY: Pose = [0, 0, 0, 1, 0, 0, 0];

export function rotate(T: Pose, x: number, y: number, z: number): [number, number, number] {
  const [qx, qy, qz, qw] = T;
  // p + 2 qw (q × p) + 2 q × (q × p)
  const cx = 2 * (qy * z - qz * y);
  const cy = 2 * (qz * x - qx * z);
  const cz = 2 * (qx * y - qy * x);
  return [x + qw * cx + qy * cz - qz * cy, y + qw * cy + qz * cx - qx * cz, z + qw * cz + qx * cy - qy * cx];
}

// T (scale p)
export function transform(T: Pose, scale: number, x: number, y: number, z: number): [number, number, number] {
  const p = rotate(T, scale * x, scale * y, scale * z);
  return [p[0] + T[4], p[1] + T[5], p[2] + T[6]];
}

// T_a_c from T_a_b and T_b_c, where lengths in c are given as if the scale of b were 1 and are multiplied by `scale` in
// a.
export function compose(T_a_b: Pose, scale: number, T_b_c: Pose): Pose {
  const [ax, ay, az, aw] = T_a_b;
  const [bx, by, bz, bw] = T_b_c;
  const t = transform(T_a_b, scale, T_b_c[4], T_b_c[5], T_b_c[6]);
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
    ...t,
  ];
}

export function inverse(T: Pose): Pose {
  const q: Pose = [-T[0], -T[1], -T[2], T[3], 0, 0, 0];
  const t = rotate(q, -T[4], -T[5], -T[6]);
  return [q[0], q[1], q[2], q[3], ...t];
}
