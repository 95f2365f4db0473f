// All messages so far, and the state after any of them: the nearest state kept before it, and what was told since.
// Memory is bounded: first the pictures and features of old frames go, then old changes of the map (going back there shows the
// map in steps), then the oldest messages altogether.
import { decode } from './decode.ts';
import type { Event, Frame, MapChange, Message } from './messages.ts';
import { State } from './state.ts';

export interface Entry {
  kind: Message['kind'];
  number: number; // of the latest frame
  time: number;
  bytes: number;
  message: Uint8Array | Message | null; // as it came, or what is left of it
}

export interface HistorySettings {
  budget: number; // bytes of messages kept
  stride: number; // bytes of messages between kept states
  states: number; // kept at most; each holds what changed in the map since the one before
  events: number; // kept at most
  thinned: number; // of old frames one in so many keeps its picture
}

export const HISTORY: HistorySettings = { budget: 256e6, stride: 4e6, states: 64, events: 5000, thinned: 10 };

interface Kept { index: number; state: State } // after entry `index`

export class History {
  readonly entries: (Entry | null)[] = []; // null: gone
  readonly events: Event[] = []; // by number
  readonly frames: { index: number; number: number; time: number; ms: readonly number[] }[] = [];
  first = 0; // entries before it are gone
  private kept: Kept[] = [];
  private bytes = 0;
  private sinceKept = 0;
  private thin = 0; // entries before it have lost their pictures
  private coarse = 0; // … and their changes of the map

  constructor(private readonly settings: HistorySettings = HISTORY) {}

  get last(): number { return this.entries.length - 1; }

  // Returns its index. `bytes` is kept: it must not change.
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

  // `state` is the one after the last message; kept when enough was told since the one before. Of too many old ones every other goes.
  keep(state: State): void {
    if (this.sinceKept < this.settings.stride) return;
    this.sinceKept = 0;
    this.kept.push({ index: this.last, state: state.clone() });
    if (this.kept.length > this.settings.states) {
      const old = this.kept.length >> 1;
      this.kept = this.kept.filter((_, i) => i >= old || i % 2 === 0);
    }
  }

  // The state after entry `index`, to be changed at will. `from`, if it is the state after `fromIndex`, may be taken on from.
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

  // Keeps within the budget. Call now and then.
  trim(): void {
    const { budget, thinned } = this.settings;
    const end = this.entries.length;
    const recent = Math.floor(this.first + 0.75 * (end - this.first)); // stays as it is
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

  // Index into `frames` of the last one not after `time`; 0 if all are.
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

  // All are told again after a whole state.
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

  // The last whole state told in a run of entries, -1: none. It tells all but hello, playback and the latest frame.
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
