// Stores all messages and computes the state after any of them, from the nearest earlier stored state and the messages
// since. Memory is bounded: first the images and features of old frames are dropped, then old map changes (seeking
// there shows the map in coarser steps), then the oldest messages.
import { decode } from './decode.ts';
import type { Event, Frame, MapChange, Message } from './messages.ts';
import { State } from './state.ts';

export interface Entry {
  kind: Message['kind'];
  number: number; // of the latest frame
  time: number;
  bytes: number;
  message: Uint8Array | Message | null; // as received, or reduced
}

export interface HistorySettings {
  budget: number; // largest size of the stored messages, bytes
  stride: number; // bytes of messages between stored states
  states: number; // largest number of stored states; each holds the map pages that changed since the previous one
  events: number; // largest number of stored events
  thinned: number; // one of this many old frames keeps its image
}

export const HISTORY: HistorySettings = { budget: 256e6, stride: 4e6, states: 64, events: 5000, thinned: 10 };

interface Kept { index: number; state: State } // the state after entry `index`

export class History {
  readonly entries: (Entry | null)[] = []; // null: dropped
  readonly events: Event[] = []; // sorted by frame number
  readonly frames: { index: number; number: number; time: number; ms: readonly number[] }[] = [];
  first = 0; // entries before this index are dropped
  private kept: Kept[] = [];
  private bytes = 0;
  private sinceKept = 0;
  private thin = 0; // entries before this index lost their images
  private coarse = 0; // entries before this index lost their map changes as well

  constructor(private readonly settings: HistorySettings = HISTORY) {}

  get last(): number { return this.entries.length - 1; }

  // Returns the entry's index. Keeps a reference to `bytes`, which must not change.
  add(bytes: Uint8Array, message: Message): number {
    const index = this.entries.length;
    const before = this.entries[index - 1];
    const entry: Entry = {
      kind: message.kind, number: before?.number ?? 0, time: before?.time ?? 0, bytes: bytes.byteLength, message: bytes,
    };
    if (message.kind === 'frame') {
      entry.number = message.number;
      entry.time = message.time;
      this.frames.push({ index, number: message.number, time: message.time, ms: message.ms });
    }
    if (message.kind === 'event') this.addEvent(message);
    this.entries.push(entry);
    this.bytes += bytes.byteLength;
    this.sinceKept += bytes.byteLength;
    return index;
  }

  // Stores `state`, the state after the last message, if enough messages arrived since the last stored one. Drops every
  // second old state when there are too many.
  keep(state: State): void {
    if (this.sinceKept < this.settings.stride) return;
    this.sinceKept = 0;
    this.kept.push({ index: this.last, state: state.clone() });
    if (this.kept.length > this.settings.states) {
      const old = this.kept.length >> 1;
      this.kept = this.kept.filter((_, i) => i >= old || i % 2 === 0);
    }
  }

  // The state after entry `index`; the caller may modify it. `from`, the state after `fromIndex`, may be reused and
  // modified.
  at(index: number, from?: State, fromIndex = -1): State {
    let state: State | undefined;
    let done = this.first - 1;
    for (const kept of this.kept) {
      if (kept.index > index || kept.index < done) continue;
      state = kept.state;
      done = kept.index;
    }
    if (from && fromIndex <= index && fromIndex >= done) {
      state = from;
      done = fromIndex;
    } else {
      const whole = this.lastWhole(done + 1, index);
      if (whole >= 0) {
        const fresh = state?.clone() ?? new State();
        this.lastOf('hello', fresh, whole);
        this.lastOf('playback', fresh, whole);
        this.lastOf('frame', fresh, whole);
        state = fresh;
        done = whole - 1;
      } else {
        state = state?.clone() ?? new State();
      }
    }
    for (let i = done + 1; i <= index; ++i) {
      const message = this.message(i);
      if (message) state.apply(message);
    }
    return state;
  }

  message(index: number): Message | null {
    const kept = this.entries[index]?.message;
    return kept instanceof Uint8Array ? decode(kept) : kept ?? null;
  }

  // Reduces memory to the budget; call periodically.
  trim(): void {
    const { budget, thinned } = this.settings;
    const end = this.entries.length;
    const recent = Math.floor(this.first + 0.75 * (end - this.first)); // newer entries are not reduced
    while (this.bytes > budget && this.thin < recent) {
      const index = this.thin++;
      const entry = this.entries[index];
      if (entry?.kind === 'frame' && index % thinned !== 0) this.replace(index, bare(this.message(index) as Frame));
    }
    while (this.bytes > budget && this.coarse < this.thin) {
      const index = this.coarse++;
      if (this.entries[index]?.kind === 'map') this.replace(index, null);
      else if (this.entries[index]?.kind === 'frame') this.replace(index, bare(this.message(index) as Frame));
    }
    while (this.bytes > budget && this.first < recent) {
      const cut = this.kept.find((kept) => kept.index > this.first && kept.index <= recent);
      if (!cut) break;
      for (; this.first <= cut.index; ++this.first) {
        this.bytes -= this.entries[this.first]?.bytes ?? 0;
        this.entries[this.first] = null;
      }
      this.kept = this.kept.filter((kept) => kept.index >= this.first - 1);
    }
  }

  get size(): number { return this.bytes; }

  // Index into `frames` of the last frame at or before `time`; 0 if there is none.
  frameAt(time: number): number {
    let low = 0;
    let high = this.frames.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.frames[middle].time <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  // Ignores duplicates, because all events are sent again after a whole state.
  private addEvent(event: Event): void {
    let at = this.events.length;
    while (at > 0 && this.events[at - 1].number > event.number) --at;
    for (let i = at - 1; i >= 0 && this.events[i].number === event.number; --i) {
      const { what, text, a, b } = this.events[i];
      if (what === event.what && text === event.text && a === event.a && b === event.b) return;
    }
    this.events.splice(at, 0, event);
    if (this.events.length > this.settings.events) this.events.shift();
  }

  private replace(index: number, message: Message | null): void {
    const entry = this.entries[index]!;
    const bytes = message === null ? 0 : 400;
    this.bytes -= entry.bytes - bytes;
    entry.bytes = bytes;
    entry.message = message;
  }

  // Index of the last whole state in a range of entries, -1: none. It contains everything except hello, playback and
  // the latest frame.
  private lastWhole(from: number, to: number): number {
    for (let i = to; i >= from; --i) {
      if (this.entries[i]?.kind !== 'map') continue;
      const message = this.message(i) as MapChange | null;
      if (message?.whole) return i;
    }
    return -1;
  }

  private lastOf(kind: Message['kind'], state: State, before: number): void {
    for (let i = before - 1; i >= this.first; --i) {
      if (this.entries[i]?.kind !== kind) continue;
      const message = this.message(i);
      if (message) state.apply(message);
      return;
    }
  }
}

function bare(frame: Frame): Frame {
  return { ...frame, picture: null, features: new Uint8Array(0), detections: [], detectionAge: -1, outlines: [] };
}
