// The landmarks of a map: id, keyframe and position in the keyframe (with lengths scaled as if its scale were 1).
// Stored without gaps: the last one replaces a removed one.
import type { Culled } from './messages.ts';
import { NONE } from './messages.ts';
import { Pages, PAGE } from './pages.ts';
import { transform } from './pose.ts';

const WORDS = 5; // 32-bit words per record: id, keyframe, x, y, z

export interface Landmark { id: number; keyframe: number; p: [number, number, number] }

export class Landmarks {
  private records = new Pages(4 * WORDS);
  private slots: Map<number, number> | null = new Map(); // by id; null: must be rebuilt from the records

  get size(): number { return this.records.length; }
  get pages() { return this.records.pages; }

  clone(): Landmarks {
    const copy = new Landmarks();
    copy.records = this.records.clone();
    copy.slots = null;
    return copy;
  }

  set(id: number, keyframe: number, x: number, y: number, z: number): void {
    const index = this.index();
    let slot = index.get(id);
    if (slot === undefined) {
      slot = this.records.length;
      index.set(id, slot);
    }
    const page = this.records.write(slot);
    const at = (slot % PAGE) * WORDS;
    page.u32[at] = id;
    page.u32[at + 1] = keyframe;
    page.f32[at + 2] = x;
    page.f32[at + 3] = y;
    page.f32[at + 4] = z;
  }

  remove(id: number): void {
    const index = this.index();
    const slot = index.get(id);
    if (slot === undefined) return;
    const last = this.records.length - 1;
    if (slot !== last) {
      const from = this.records.read(last).u32;
      const words = from.subarray((last % PAGE) * WORDS, (last % PAGE + 1) * WORDS);
      this.records.write(slot).u32.set(words, (slot % PAGE) * WORDS);
      index.set(words[0], slot);
    }
    this.records.truncate(last);
    index.delete(id);
  }

  get(id: number): Landmark | undefined {
    const slot = this.index().get(id);
    return slot === undefined ? undefined : this.at(slot);
  }

  at(slot: number): Landmark {
    const page = this.records.read(slot);
    const at = (slot % PAGE) * WORDS;
    return { id: page.u32[at], keyframe: page.u32[at + 1], p: [page.f32[at + 2], page.f32[at + 3], page.f32[at + 4]] };
  }

  // Moves landmarks of culled keyframes to the keyframes that replace them, or removes them.
  follow(culled: ReadonlyMap<number, Culled>): void {
    const gone: number[] = [];
    for (let slot = 0; slot < this.records.length; ++slot) {
      const at = (slot % PAGE) * WORDS;
      const move = culled.get(this.records.read(slot).u32[at + 1]);
      if (!move) continue;
      if (move.follows === NONE) {
        gone.push(this.records.read(slot).u32[at]);
        continue;
      }
      const page = this.records.write(slot);
      page.u32[at + 1] = move.follows;
      page.f32.set(transform(move.T_follows_culled, move.scale, page.f32[at + 2], page.f32[at + 3], page.f32[at + 4]), at + 2);
    }
    for (const id of gone) this.remove(id);
  }

  private index(): Map<number, number> {
    if (this.slots === null) {
      this.slots = new Map();
      for (let slot = 0; slot < this.records.length; ++slot) {
        this.slots.set(this.records.read(slot).u32[(slot % PAGE) * WORDS], slot);
      }
    }
    return this.slots;
  }
}
