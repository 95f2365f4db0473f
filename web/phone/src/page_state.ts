// State of the phone page: plain values. Only apply() changes it; page_view.ts draws it.
import type { Message } from '../../scene/src/messages.ts';
import { State } from '../../scene/src/state.ts'; // directly, because the package's scene requires a browser
import type { Cube } from './cube.ts';
import type { MotionState } from './motion.ts';
import type { Done } from './protocol.ts';
import type { Length, Ruler } from './ruler.ts';
import type { Choices } from './settings.ts';

export type Phase = 'idle' | 'running' | 'ended';

// info.json: the server's capabilities.
export interface Info { connected?: boolean; core?: boolean; threads?: boolean }

export interface Progress { seconds: number; duration: number } // of a video file

export type PageMessage =
  | { kind: 'info'; info: Info }
  | { kind: 'choices'; choices: Choices }
  | { kind: 'opening'; opening: boolean } // the camera is being opened
  | { kind: 'begin'; remote: boolean; fov: number | null } // a session with an empty map
  | { kind: 'anew' } // the session continues with another, empty map
  | { kind: 'reset' } // there is no session any more
  | { kind: 'phase'; phase: Phase; why?: string }
  | { kind: 'done'; done: Done; messages: readonly Message[] }
  | { kind: 'stream'; messages: readonly Message[] }
  | { kind: 'cube'; cube: Cube | null }
  | { kind: 'measuring'; measuring: boolean } // taps are the ruler's
  | { kind: 'ruler'; ruler: Ruler }
  | { kind: 'motion'; motion: MotionState }
  | { kind: 'recording'; images: number | null }
  | { kind: 'progress'; progress: Progress | null }
  | { kind: 'notice'; about: string; text: string }; // '' removes the notice of this topic

export type Dispatch = (message: PageMessage) => void;

export class PageState {
  phase: Phase = 'idle';
  why = ''; // why the session ended by itself; '': the user ended it
  info: Info | null = null; // null: not known yet
  opening = false; // the camera is being opened
  session: { remote: boolean; fov: number | null } | null = null; // as it began
  map = new State();
  shown: Done | null = null; // the last processed image
  cube: Cube | null = null;
  measuring = false; // taps are the ruler's
  ruler: Ruler | null = null;
  motion: MotionState = 'none'; // of the device's inertial sensor
  recording: number | null = null; // images recorded so far; null: not recording
  progress: Progress | null = null;
  readonly counters = { processed: 0, milliseconds: [] as number[] };
  readonly notices = new Map<string, string>(); // by topic
  revision = 0; // increases with each change of what the image and the map show

  constructor(public choices: Choices) {}

  // Whether the next session's images are sent to the computer that serves the page.
  get remote(): boolean {
    return Boolean(this.info?.connected && (this.choices.connected || this.info.core === false));
  }

  // Between the ruler's ends; null: it does not have two, or lengths are not known.
  get measured(): Length | null {
    const inertial = this.shown?.inertial;
    return inertial?.metric ? this.ruler?.measure(this.map, inertial.scaleSigma) ?? null : null;
  }

  // Whether there is a map.
  get savable(): boolean { return this.session !== null && (this.shown?.frame.counts.keyframes ?? 0) > 0; }

  apply(message: PageMessage): void {
    switch (message.kind) {
      case 'info':
        this.info = message.info;
        break;
      case 'choices':
        this.choices = message.choices;
        ++this.revision;
        break;
      case 'opening':
        this.opening = message.opening;
        break;
      case 'begin':
        this.forget();
        this.session = { remote: message.remote, fov: message.fov };
        break;
      case 'anew':
        this.emptyMap();
        break;
      case 'reset':
        this.forget();
        this.session = null;
        break;
      case 'phase':
        this.phase = message.phase;
        this.why = message.why ?? '';
        break;
      case 'done':
        this.take(message.messages);
        this.ruler?.update(this.map, message.done.spreads);
        this.count(message.done.frame.milliseconds);
        this.shown?.bitmap?.close();
        this.shown = message.done;
        break;
      case 'stream':
        this.take(message.messages);
        break;
      case 'cube':
        this.cube = message.cube;
        ++this.revision;
        break;
      case 'measuring':
        this.measuring = message.measuring;
        this.ruler = null;
        ++this.revision;
        break;
      case 'ruler':
        this.ruler = message.ruler;
        ++this.revision;
        break;
      case 'motion':
        this.motion = message.motion;
        break;
      case 'recording':
        this.recording = message.images;
        break;
      case 'progress':
        this.progress = message.progress;
        break;
      case 'notice':
        if (message.text) this.notices.set(message.about, message.text);
        else this.notices.delete(message.about);
        break;
    }
  }

  private take(messages: readonly Message[]): void {
    for (const message of messages) {
      this.cube?.follow(message);
      this.ruler?.follow(message);
      this.map.apply(message);
    }
    if (this.cube && !this.cube.position(this.map)) this.cube = null;
    if (this.ruler && !this.ruler.positions(this.map)) this.ruler = null;
    ++this.revision;
  }

  private count(milliseconds: number): void {
    ++this.counters.processed;
    this.counters.milliseconds.push(milliseconds);
    if (this.counters.milliseconds.length > 1000) this.counters.milliseconds.shift();
  }

  private emptyMap(): void {
    this.map = new State();
    this.cube = null;
    this.ruler = null;
    ++this.revision;
  }

  private forget(): void {
    this.emptyMap();
    this.shown?.bitmap?.close();
    this.shown = null;
    this.progress = null;
    this.measuring = false;
    this.motion = 'none';
    this.counters.processed = 0;
    this.counters.milliseconds = [];
    this.notices.clear();
  }
}
