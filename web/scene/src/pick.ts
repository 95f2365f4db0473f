// The drawn point under the pointer.
import type { Anchors } from './anchors.ts';
import type { PointLayer } from './points.ts';
import type { Vector } from './pose.ts';

const NEAR = 6; // CSS pixels: of the points this close the foremost is taken
const FAR = 16; // CSS pixels: otherwise the closest up to here

// `clip`: world to clip coordinates, 16 numbers by column. `x`, `y`: CSS pixels in an image of this size.
export function pick(layers: readonly PointLayer[], anchors: Anchors, clip: readonly number[], width: number, height: number, x: number, y: number): Vector | null {
  let front = Infinity;
  let close = FAR;
  let best: Vector | null = null;
  for (const layer of layers) {
    for (let i = 0; i < layer.count; ++i) {
      const p = anchors.place(layer.slotOf(i), layer.at(i));
      if (!p) continue;
      const w = clip[3]! * p[0] + clip[7]! * p[1] + clip[11]! * p[2] + clip[15]!;
      if (w <= 0 || w >= front) continue;
      const u = (0.5 + (0.5 * (clip[0]! * p[0] + clip[4]! * p[1] + clip[8]! * p[2] + clip[12]!)) / w) * width;
      const v = (0.5 - (0.5 * (clip[1]! * p[0] + clip[5]! * p[1] + clip[9]! * p[2] + clip[13]!)) / w) * height;
      const away = Math.hypot(u - x, v - y);
      if (away <= NEAR) {
        front = w;
        best = p;
      } else if (front === Infinity && away < close) {
        close = away;
        best = p;
      }
    }
  }
  return best;
}
