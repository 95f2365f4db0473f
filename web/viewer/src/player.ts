// What is shown: the latest state (attached), or one of the past, standing still or playing on.
import { decode, History, HISTORY, State } from '@alidade/scene';
import type { Message } from '@alidade/scene';

export class Player {
  history: History;
  latest = new State(); // the sum of all messages
  shown = this.latest;
  index = -1; // of the last message that is in `shown`
  attached = true;
  playing = false;
  speed = 1;
  private debt = 0; // seconds of the recording to be played

  constructor(private readonly budget = HISTORY.budget) {
    this.history = new History({ ...HISTORY, budget });
  }

  // Another run.
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

  // Stands still at what is shown now.
  detach(): void {
    if (!this.attached) return;
    this.attached = false;
    this.playing = false;
    this.shown = this.latest.clone();
  }

  // To the last frame whose number is not above.
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

  // Some time has gone by. Returns whether something else is shown now; at the end it attaches when `toLatest`, else stops.
  tick(seconds: number, toLatest: boolean): boolean {
    if (!this.playing) return false;
    const { frames } = this.history;
    this.debt += seconds * this.speed;
    let at = this.frame();
    const from = at;
    // Pauses of the recording longer than a second are shortened to one.
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

  // Index into history.frames of what is shown.
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
    // What a frame changed in the map is told before it; after the last one what was done at the end.
    const end = i + 1 < frames.length ? frames[i].index : this.history.last;
    this.attached = false;
    if (!goesOn) this.playing = false;
    this.show(Math.max(end, this.history.first));
  }

  private show(index: number): void {
    const from = this.shown === this.latest ? undefined : this.shown;
    this.shown = this.history.at(index, from, this.index);
    this.shown.hello = this.latest.hello; // the truth of a rendered recording is told at its end
    this.index = index;
  }
}
