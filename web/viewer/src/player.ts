// Selects the state to show: the latest one (attached), or a past one, paused or playing.
import { decode, History, HISTORY, State } from '@alidade/scene';
import type { Message } from '@alidade/scene';

export class Player {
  history: History;
  latest = new State(); // the sum of all messages
  shown = this.latest;
  index = -1; // index of the last message included in `shown`
  attached = true;
  playing = false;
  speed = 1;
  private debt = 0; // seconds of the recording still to be played

  constructor(private readonly budget = HISTORY.budget) {
    this.history = new History({ ...HISTORY, budget });
  }

  // Clears everything for another run.
  reset(): void {
    this.history = new History({ ...HISTORY, budget: this.budget });
    this.latest = new State();
    this.shown = this.latest;
    this.index = -1;
    this.attached = true;
    this.playing = false;
  }

  push(bytes: Uint8Array): Message {
    const message = decode(bytes);
    const index = this.history.add(bytes, message);
    this.latest.apply(message);
    this.history.keep(this.latest);
    this.history.trim();
    if (this.attached) this.index = index;
    else if (this.index < this.history.first) this.show(this.history.first);
    return message;
  }

  attach(): void {
    this.attached = true;
    this.playing = false;
    this.shown = this.latest;
    this.index = this.history.last;
  }

  // Pauses at the state shown now.
  detach(): void {
    if (!this.attached) return;
    this.attached = false;
    this.playing = false;
    this.shown = this.latest.clone();
  }

  // Seeks to the last frame up to this number.
  seek(number: number): void {
    const { frames } = this.history;
    let at = 0;
    for (let high = frames.length - 1; at < high;) {
      const middle = (at + high + 1) >> 1;
      if (frames[middle].number <= number) at = middle;
      else high = middle - 1;
    }
    if (frames.length > 0) this.showFrame(at);
  }

  step(by: number): void {
    this.detach();
    this.playing = false;
    this.showFrame(this.frame() + by);
  }

  play(): void {
    this.detach();
    this.debt = 0;
    if (this.frame() >= this.history.frames.length - 1) this.showFrame(0);
    this.playing = true;
  }

  // Advances playback by `seconds`. Returns whether another frame is shown. At the end it attaches when `toLatest`,
  // else stops.
  tick(seconds: number, toLatest: boolean): boolean {
    if (!this.playing) return false;
    const { frames } = this.history;
    this.debt += seconds * this.speed;
    let at = this.frame();
    const from = at;
    // gaps in the recording are shortened to one second
    for (; at + 1 < frames.length; ++at) {
      const lasts = Math.min(1, Math.max(0, frames[at + 1].time - frames[at].time));
      if (lasts > this.debt) break;
      this.debt -= lasts;
    }
    if (at !== from) this.showFrame(at, true);
    if (at + 1 >= frames.length) {
      if (toLatest) this.attach();
      else this.playing = false;
      return true;
    }
    return at !== from;
  }

  // Index into history.frames of the frame shown.
  frame(): number {
    const { frames } = this.history;
    let low = 0;
    for (let high = frames.length - 1; low < high;) {
      const middle = (low + high + 1) >> 1;
      if (frames[middle].index <= this.index) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  private showFrame(at: number, goesOn = false): void {
    const { frames } = this.history;
    const i = Math.max(0, Math.min(frames.length - 1, at));
    // A frame's map changes precede its message; after the last frame include the final changes.
    const end = i + 1 < frames.length ? frames[i].index : this.history.last;
    this.attached = false;
    if (!goesOn) this.playing = false;
    this.show(Math.max(end, this.history.first));
  }

  private show(index: number): void {
    const from = this.shown === this.latest ? undefined : this.shown;
    this.shown = this.history.at(index, from, this.index);
    this.shown.hello = this.latest.hello; // the ground truth of a rendered recording arrives at its end
    this.index = index;
  }
}
