// The frames so far, by number: state, and the camera's pose relative to a keyframe (with lengths scaled as if its
// scale were 1).
import type { Culled, PathFrame, Pose } from './messages.ts';
import { NONE, STATES } from './messages.ts';
import { Pages, PAGE } from './pages.ts';
import { compose, IDENTITY } from './pose.ts';

// 32-bit words per record: time and the pose's 7 numbers as doubles, number, reference, state, padding.
const WORDS = 20;
const DOUBLES = WORDS / 2;

export class Path {
  private records = new Pages(4 * WORDS);

  get length(): number { return this.records.length; }
  read(i: number) { return this.records.read(i); }

  clone(): Path {
    const copy = new Path();
    copy.records = this.records.clone();
    return copy;
  }

  at(i: number): PathFrame {
    const page = this.records.read(i);
    const word = (i % PAGE) * WORDS;
    const double = (i % PAGE) * DOUBLES;
    return {
      time: page.f64[double], T_reference_camera: [...page.f64.subarray(double + 1, double + 8)],
      number: page.u32[word + 16] | 0, reference: page.u32[word + 17], state: STATES[page.u32[word + 18]],
    };
  }

  // Adds frames, which mostly arrive in order; replaces frames that are already stored.
  set(frames: readonly PathFrame[]): void {
    let late: PathFrame[] | null = null;
    for (const frame of frames) {
      const i = this.find(frame.number);
      if (i === this.length || this.number(i) === frame.number) this.write(i, frame);
      else (late ??= []).push(frame);
    }
    if (late) this.insert(late);
  }

  // Re-anchors frames of culled keyframes to the keyframes that replace them; without a replacement the pose becomes
  // unknown.
  follow(culled: ReadonlyMap<number, Culled>): void {
    for (let i = 0; i < this.length; ++i) {
      const move = culled.get(this.records.read(i).u32[(i % PAGE) * WORDS + 17]);
      if (!move) continue;
      const frame = this.at(i);
      const known = move.follows !== NONE;
      const T: Pose = known ? compose(move.T_follows_culled, move.scale, frame.T_reference_camera) : IDENTITY;
      this.write(i, { ...frame, reference: move.follows, T_reference_camera: T });
    }
  }

  // Calls visit(number, index into STATES) for every frame.
  states(visit: (number: number, state: number) => void): void {
    for (let i = 0; i < this.length; ++i) {
      const { u32 } = this.records.read(i);
      const word = (i % PAGE) * WORDS;
      visit(u32[word + 16] | 0, u32[word + 18]);
    }
  }

  // Index of the first frame with this number or a higher one; `length` if there is none.
  find(number: number): number {
    let low = 0;
    let high = this.length;
    if (high > 0 && this.number(high - 1) < number) return high;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.number(middle) < number) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private number(i: number): number {
    return this.records.read(i).u32[(i % PAGE) * WORDS + 16] | 0;
  }

  private write(i: number, frame: PathFrame): void {
    const page = this.records.write(i);
    const word = (i % PAGE) * WORDS;
    const double = (i % PAGE) * DOUBLES;
    page.f64[double] = frame.time;
    page.f64.set(frame.T_reference_camera, double + 1);
    page.u32[word + 16] = frame.number;
    page.u32[word + 17] = frame.reference;
    page.u32[word + 18] = STATES.indexOf(frame.state);
  }

  private insert(late: PathFrame[]): void {
    const all = new Map<number, PathFrame>();
    for (let i = 0; i < this.length; ++i) all.set(this.number(i), this.at(i));
    for (const frame of late) all.set(frame.number, frame);
    [...all.values()].sort((a, b) => a.number - b.number).forEach((frame, i) => this.write(i, frame));
  }
}
