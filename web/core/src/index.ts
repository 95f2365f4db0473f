// Visual SLAM in JavaScript: pictures of one moving camera in, its pose and a map out.
//
//   import { Slam } from 'alidade';
//   const slam = await Slam.create({ width: 640, height: 480 });
//   const frame = slam.track(imageData, seconds);
//   if (frame.pose) console.log(frame.pose.position, frame.counts.keyframes);
//
// The core is the C++ one, as WebAssembly. Calls are synchronous and take milliseconds: in a page, make them in a Worker.

/** What the compiled module offers; `memory` may be replaced when it grows, so views are made anew for each use. */
interface Core {
  HEAPU8: Uint8Array;
  _malloc(bytes: number): number;
  _free(at: number): void;
  UTF8ToString(at: number): string;
  stringToUTF8(text: string, at: number, bytes: number): void;
  lengthBytesUTF8(text: string): number;
  _alidade_error(): number;
  _alidade_new(width: number, height: number, fov: number, threads: number, settings: number, classes: number): number;
  _alidade_new_calibrated(width: number, height: number, camera: number, threads: number, settings: number, classes: number): number;
  _alidade_delete(session: number): void;
  _alidade_pixels(session: number): number;
  _alidade_track(session: number, channels: number, time: number): number;
  _alidade_reason(session: number): number;
  _alidade_features(session: number, at: number): number;
  _alidade_detected(session: number, number: number, found: number, count: number): number;
  _alidade_bytes(session: number, what: number, at: number): number;
  _alidade_finish(session: number): number;
}
type CreateCore = (options: { wasmBinary?: ArrayBuffer | Uint8Array; locateFile?: (name: string) => string; threadPool?: number }) => Promise<Core>;
const STAGES = 4; // threads that are there besides those of `threads`: mapping, loop closing, semi-dense, what OpenCV takes

export interface Calibration {
  fx: number; fy: number; cx: number; cy: number;             // pixels; the centre of the top-left pixel is 0, 0
  distortion?: [number, number, number, number, number];      // k1 k2 p1 p2 k3 (Brown)
}

export interface SlamOptions {
  width: number;                    // of the pictures, pixels
  height: number;
  fov?: number;                     // horizontal field of view, degrees; left out: found on the way
  camera?: Calibration;             // instead of `fov`
  settings?: Record<string, string | number | boolean>;  // as after --set of the program, e.g. { 'semidense.enabled': true }
  /** Names of the classes of a detector whose answers will come (detected()): what it finds of people, animals and vehicles is left out. */
  classes?: readonly string[];
  /** Threads; needs a page that is cross-origin isolated, and the threaded module. Default: 1. */
  threads?: number;
  /** Where alidade.mjs and alidade.wasm are: a folder's address, ending in /. Default: beside this file, in single/ or threads/. */
  base?: string;
  wasmBinary?: ArrayBuffer | Uint8Array;                 // instead of fetching alidade.wasm (Node)
}

export type State = 'initialising' | 'tracking' | 'lost';

export interface Pose {
  position: [number, number, number];            // of the camera in the world, map units
  orientation: [number, number, number, number]; // quaternion x y z w: turns the camera's x right, y down, z ahead into the world's
}

export interface Frame {
  number: number;           // of the pictures given to track(), from 0
  state: State;
  pose: Pose | null;        // null: not known
  predicted: boolean;       // the pose is a guess: lost for a moment only
  reason: string;           // why there is none; '' while tracking
  counts: { keyframes: number; landmarks: number; matches: number; features: number; maps: number };
  milliseconds: number;     // it took
  fov: number;              // horizontal field of view as it is believed to be, degrees
  fovSigma: number;         // its standard deviation, degrees; 0: it was given
  cameraChanges: number;    // how often the map was changed to another camera, found from it
}

export interface Feature { x: number; y: number; matched: boolean }  // pixels of the picture as it is worked on

export interface Detection {
  class: number;                                           // of the classes named
  score: number;                                           // 0…1
  x: number; y: number; width: number; height: number;     // pixels of the picture, from edge to edge: the first one covers 0 to 1
}

const STATES: State[] = ['initialising', 'tracking', 'lost'];
const NUMBERS = 20;
const DETECTION = 6; // numbers of one
const enum Bytes { Messages = 0, Trajectory = 1, Map = 2, Cloud = 3 }

/** What went wrong, as the core says it. */
export class AlidadeError extends Error {
  override name = 'AlidadeError';
}

export class Slam {
  readonly width: number;
  readonly height: number;
  #core: Core;
  #session: number;
  #out: number;  // four bytes, for addresses

  private constructor(core: Core, session: number, width: number, height: number) {
    this.#core = core;
    this.#session = session;
    this.#out = core._malloc(4);
    this.width = width;
    this.height = height;
  }

  /** Loads the core and begins. Throws AlidadeError on sizes, cameras and settings that cannot be. */
  static async create(options: SlamOptions): Promise<Slam> {
    const threads = options.threads ?? 1;
    const base = options.base ?? new URL(threads > 1 ? './threads/' : './single/', import.meta.url).href;
    const module = await import(/* @vite-ignore */ base + 'alidade.mjs') as { default: CreateCore };
    const core = await module.default({
      locateFile: (name) => base + name, threadPool: threads > 1 ? threads + STAGES : 1, ...(options.wasmBinary ? { wasmBinary: options.wasmBinary } : {}),
    });
    const { width, height } = options;
    if (!(Number.isInteger(width) && Number.isInteger(height) && width > 0 && height > 0 && width * height <= 1 << 26))
      throw new AlidadeError(`pictures of ${width}x${height} pixels cannot be`);
    const lines = Object.entries(options.settings ?? {})
      .map(([name, value]) => `${name}=${typeof value === 'boolean' ? Number(value) : value}`).join('\n');
    const copy = (words: string) => {
      const bytes = core.lengthBytesUTF8(words) + 1;
      const at = core._malloc(bytes);
      core.stringToUTF8(words, at, bytes);
      return at;
    };
    const text = copy(lines);
    const classes = copy((options.classes ?? []).map((name) => name.replaceAll('\n', ' ')).join('\n'));
    let session: number;
    if (options.camera) {
      const { fx, fy, cx, cy, distortion = [0, 0, 0, 0, 0] } = options.camera;
      const numbers = core._malloc(9 * 8);
      new Float64Array(core.HEAPU8.buffer, numbers, 9).set([fx, fy, cx, cy, ...distortion]);
      session = core._alidade_new_calibrated(width, height, numbers, threads, text, classes);
      core._free(numbers);
    } else {
      session = core._alidade_new(width, height, options.fov ?? 0, threads, text, classes);
    }
    core._free(text);
    core._free(classes);
    if (session === 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
    return new Slam(core, session, width, height);
  }

  /** One picture: ImageData, or its bytes, 4 (red green blue alpha) or 1 (grey) a pixel. `time` in seconds. */
  track(picture: ImageData | Uint8Array | Uint8ClampedArray, time: number): Frame {
    const core = this.#live();
    const bytes = 'data' in picture ? picture.data : picture;
    const channels = bytes.length / (this.width * this.height);
    if (channels !== 1 && channels !== 4)
      throw new AlidadeError(`a picture of ${bytes.length} bytes is not one of ${this.width}x${this.height} pixels`);
    core.HEAPU8.set(bytes, core._alidade_pixels(this.#session));
    const at = core._alidade_track(this.#session, channels, time);
    if (at === 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
    const n = Array.from(new Float64Array(core.HEAPU8.buffer, at, NUMBERS)) as [number, ...number[]];
    const [state, placed, predicted, keyframes, landmarks, matches, features, maps, milliseconds, fov, fovSigma, cameraChanges] = n as number[] & { length: 19 };
    return {
      number: n[19]!,
      state: STATES[state!] ?? 'lost',
      pose: placed ? { position: [n[12]!, n[13]!, n[14]!], orientation: [n[15]!, n[16]!, n[17]!, n[18]!] } : null,
      predicted: predicted === 1,
      reason: state === 1 ? '' : core.UTF8ToString(core._alidade_reason(this.#session)),
      counts: { keyframes: keyframes!, landmarks: landmarks!, matches: matches!, features: features!, maps: maps! },
      milliseconds: milliseconds!, fov: fov!, fovSigma: fovSigma!, cameraChanges: cameraChanges!,
    };
  }

  /** What a detector found in an earlier picture, Frame.number; it may come many pictures late. The numbers of a Detection one after the other will do as well. */
  detected(number: number, found: readonly Detection[] | Float32Array): void {
    const core = this.#live();
    const numbers = found instanceof Float32Array ? found : Float32Array.from(found.flatMap((d) => [d.class, d.score, d.x, d.y, d.width, d.height]));
    const at = core._malloc(Math.max(4, numbers.byteLength));
    new Float32Array(core.HEAPU8.buffer, at, numbers.length).set(numbers);
    const told = core._alidade_detected(this.#session, number, at, Math.floor(numbers.length / DETECTION));
    core._free(at);
    if (told !== 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
  }

  /** The last picture's features. */
  features(): Feature[] {
    const core = this.#live();
    const count = core._alidade_features(this.#session, this.#out);
    const numbers = new Float32Array(core.HEAPU8.buffer, this.#address(core), 3 * count);
    return Array.from({ length: count }, (_, i) => ({ x: numbers[3 * i]!, y: numbers[3 * i + 1]!, matched: numbers[3 * i + 2] === 1 }));
  }

  /** The viewer's messages since they were asked for last: src/alidade/stream, decoded and drawn by web/scene. */
  messages(): Uint8Array[] {
    const all = this.#bytes(Bytes.Messages);
    const view = new DataView(all.buffer, all.byteOffset, all.byteLength);
    const messages: Uint8Array[] = [];
    for (let at = 0; at < all.length;) {
      const size = view.getUint32(at, true);
      messages.push(all.slice(at + 4, at + 4 + size));  // of their own, so that they begin aligned
      at += 4 + size;
    }
    return messages;
  }

  /** Every frame with a pose, TUM format: seconds, position, quaternion x y z w. */
  trajectory(): string { return new TextDecoder().decode(this.#bytes(Bytes.Trajectory)); }
  /** map.alidade: `alidade view`, `alidade run --load`. */
  map(): Uint8Array { return this.#bytes(Bytes.Map); }
  /** Landmarks as a binary PLY file. */
  cloud(): Uint8Array { return this.#bytes(Bytes.Cloud); }

  /** Ends what is still in work, and adjusts the map as a whole once more. */
  finish(): void {
    const core = this.#live();
    if (core._alidade_finish(this.#session) !== 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
  }

  /** Gives its memory back; no other call may follow. */
  delete(): void {
    if (this.#session === 0) return;
    this.#core._alidade_delete(this.#session);
    this.#core._free(this.#out);
    this.#session = 0;
  }

  #live(): Core {
    if (this.#session === 0) throw new AlidadeError('this Slam was deleted');
    return this.#core;
  }
  #address(core: Core): number { return new Uint32Array(core.HEAPU8.buffer, this.#out, 1)[0]!; }
  #bytes(what: Bytes): Uint8Array {
    const core = this.#live();
    const count = core._alidade_bytes(this.#session, what, this.#out);
    if (count < 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
    return core.HEAPU8.slice(this.#address(core), this.#address(core) + count);
  }
}
