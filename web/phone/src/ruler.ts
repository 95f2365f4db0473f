// The distance between two landmarks that the user taps, with its standard deviation.
import type { Message, State } from '@alidade/scene';
import { inverse, transform } from '../../scene/src/pose.ts'; // directly, because the package's scene requires a browser
import type { Vector } from '../../scene/src/pose.ts';
import { project } from './lens.ts';
import type { Point } from './lens.ts';
import { visible } from './visible.ts';

const REACH = 0.05; // share of the image width: from a tap to the landmark that is meant

// What the core knows of a landmark's position: its 3×3 covariance in the world; null: its depth is not determined yet.
export type Spread = readonly number[] | null;

interface End {
  id: number; // of the landmark
  keyframe: number; p: Vector; // where it was when it was last known: in a keyframe, lengths as if its scale were 1
  spread: Spread;
}

export interface Length { length: number; sigma: number } // meters; sigma: infinite: not determined

export class Ruler {
  private constructor(private readonly ends: readonly End[]) {}

  // With an end at the landmark nearest to `tap` (pixels of the stream's camera), after those of `before` if that has
  // one; null: there is none near.
  static place(state: State, tap: Point, before: Ruler | null): Ruler | null {
    const camera = state.hello?.camera;
    const T_world_camera = state.cameraPose();
    if (!camera || !T_world_camera) return null;
    let best: number | null = null;
    let least = REACH * camera.width;
    for (const { id, pixel } of visible(state, camera, T_world_camera)) {
      const off = Math.hypot(pixel[0] - tap[0], pixel[1] - tap[1]);
      if (off < least) [best, least] = [id, off];
    }
    const landmark = best === null ? undefined : state.landmarks.get(best);
    if (!landmark) return null;
    const kept = before?.ends.length === 1 && before.ends[0]!.id !== landmark.id ? before.ends : [];
    return new Ruler([...kept, { id: landmark.id, keyframe: landmark.keyframe, p: landmark.p, spread: null }]);
  }

  get landmarks(): number[] { return this.ends.map(({ id }) => id); }

  // Call before the state applies the message: an end whose keyframe is culled moves to the one that replaces it.
  follow(message: Message): void {
    if (message.kind !== 'map') return;
    for (const end of this.ends) {
      for (let moved = true; moved;) {
        const culled = message.culled.find(({ id }) => id === end.keyframe);
        moved = culled !== undefined;
        if (!culled) continue;
        end.keyframe = culled.follows;
        end.p = transform(culled.T_follows_culled, culled.scale, ...end.p);
      }
    }
  }

  // Call after the state has applied the messages of an image. `spreads`: what the core said with it, by landmark. Ends
  // follow their landmarks; one that was removed stays where it was.
  update(state: State, spreads: Readonly<Record<number, Spread>>): void {
    for (const end of this.ends) {
      const landmark = state.landmarks.get(end.id);
      if (landmark) [end.keyframe, end.p] = [landmark.keyframe, landmark.p];
      end.spread = spreads[end.id] ?? end.spread;
    }
  }

  // In the world; null: the part of the map is gone.
  positions(state: State): Vector[] | null {
    const found: Vector[] = [];
    for (const { keyframe, p } of this.ends) {
      const of = state.keyframes.get(keyframe);
      if (!of) return null;
      found.push(transform(of.T_world_camera, of.scale, ...p));
    }
    return found;
  }

  // Null: it does not have two ends. `scaleSigma`: relative, of the map's lengths. Variances add: that of the scale, and
  // those of the ends along the line.
  measure(state: State, scaleSigma: number): Length | null {
    const [a, b] = this.positions(state) ?? [];
    if (!a || !b) return null;
    const way: Vector = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    const length = Math.hypot(...way);
    let variance = (length * scaleSigma) ** 2;
    for (const { spread } of this.ends) {
      if (!spread) return { length, sigma: Infinity };
      for (let r = 0; r < 3; ++r) for (let c = 0; c < 3; ++c) variance += (way[r]! * spread[3 * r + c]! * way[c]!) / Math.max(length * length, 1e-12);
    }
    return { length, sigma: Math.sqrt(variance) };
  }
}

// In the latest image; points behind the camera are left out.
export function pixelsOf(state: State, positions: readonly Vector[]): Point[] {
  const T_world_camera = state.cameraPose();
  const camera = state.hello?.camera;
  if (!T_world_camera || !camera) return [];
  const T = inverse(T_world_camera);
  return positions.map((p) => project(camera, transform(T, 1, ...p))).filter((pixel) => pixel !== null);
}
