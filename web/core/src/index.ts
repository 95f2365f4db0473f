// Visual SLAM in JavaScript: images of one moving camera in, its pose and a map out.
//
//   import { Slam } from 'alidade';
//   const slam = await Slam.create({ width: 640, height: 480 });
//   const frame = slam.track(seconds, imageData);
//   if (frame.pose) console.log(frame.pose.position, frame.counts.keyframes);
//
// The core is the C++ library compiled to WebAssembly. Calls are synchronous and take milliseconds; in a page, make
// them in a Worker.

import { FAILURES, REASONS } from './generated/failures.js';
import type { Failure } from './generated/failures.js';
import { FRAME_NUMBERS, INERTIAL_NUMBERS } from './generated/frame_numbers.js';

export { FAILURES, REASONS };
export type { Failure };

/**
 * Interface of the compiled module. Its memory may be replaced when it grows, so views must be created for each use.
 */
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
  _alidade_features(session: number, at: number): number;
  _alidade_detected(session: number, number: number, found: number, count: number): number;
  _alidade_moved(session: number, readings: number, count: number): number;
  _alidade_inertial(session: number): number;
  _alidade_covariance(session: number, landmark: number): number;
  _alidade_bytes(session: number, what: number, at: number): number;
  _alidade_finish(session: number): number;
}
type CreateCore = (options: { wasmBinary?: ArrayBuffer | Uint8Array; locateFile?: (name: string) => string; threadPool?: number }) => Promise<Core>;
const STAGES = 4; // additional threads besides `threads`: mapping, loop closing, semi-dense mapping, OpenCV

export interface Calibration {
  fx: number; fy: number; cx: number; cy: number; // pixels; the center of the top-left pixel is 0, 0
  distortion?: [number, number, number, number, number]; // k1 k2 p1 p2 k3 (Brown)
}

export interface SlamOptions {
  width: number; // of the images, pixels
  height: number;
  fov?: number; // horizontal field of view, degrees; omitted: self-calibrated
  camera?: Calibration; // used instead of `fov`
  // As after --set of the program, for example { 'semidense.enabled': true }.
  settings?: Record<string, string | number | boolean>;
  /**
   * Class names of an external detector, whose results are passed to detected(). Detected people, animals and vehicles
   * are excluded.
   */
  classes?: readonly string[];
  /** Number of threads; more than 1 requires a cross-origin isolated page and the threaded module. Default: 1. */
  threads?: number;
  /**
   * URL of the folder with alidade.mjs and alidade.wasm, ending in /. Default: single/ or threads/ beside this file.
   */
  base?: string;
  wasmBinary?: ArrayBuffer | Uint8Array; // used instead of fetching alidade.wasm (Node)
}

export type State = 'initializing' | 'tracking' | 'lost';

export interface Pose {
  position: [number, number, number]; // of the camera in the world, map units
  // Quaternion x y z w: rotates the camera's axes (x right, y down, z forward) into the world.
  orientation: [number, number, number, number];
}

/** By the inertial sensor: the world's z axis is up, and the camera looked along its x axis in the first image. */
export interface Orientation {
  rotation: [number, number, number, number]; // quaternion x y z w: rotates the camera's axes into that world
  tiltSigma: number; // standard deviation of the vertical, radians
  headingSigma: number; // standard deviation of the angle about the vertical since the first image, radians
}

export interface Frame {
  number: number; // number of the image passed to track(), from 0
  state: State;
  pose: Pose | null; // null unless tracking
  predicted: Pose | null; // recently lost: extrapolated from the motion, a guess; null otherwise
  orientation: Orientation | null; // with inertial readings, in every state, once the sensor's mounting is known
  failure: Failure | null; // why there is no pose; null while tracking
  reason: string; // `failure` in words; '' for null
  counts: { keyframes: number; landmarks: number; matches: number; features: number; maps: number };
  milliseconds: number; // processing time
  fov: number; // current estimate of the horizontal field of view, degrees
  fovSigma: number; // its standard deviation, degrees; 0: the field of view was given
  cameraChanges: number; // number of times the map was rebuilt with a new estimate of the camera
}

export interface Feature { x: number; y: number; matched: boolean } // pixels of the processed image

/** What images and inertial readings together tell so far, as of the last image. */
export interface Inertial {
  samples: number; // readings so far
  metric: boolean; // lengths are meters: poses, map and landmarks
  scaleSigma: number; // relative standard deviation of those lengths; 0: unknown
  gravity: [number, number, number] | null; // direction in which things fall, unit vector in the world; null: unknown
  gravitySigma: number; // standard deviation of its direction, radians
  timeOffset: number; // an image of time t was taken at t + timeOffset on the clock of the readings, seconds
  timeOffsetSigma: number; // seconds; 0: unknown
  missing: string; // what the readings do not tell yet, as a sentence; '': nothing, or there are no readings
  leftOut: string; // why the readings are not used, as a sentence; '': they are
}

export interface Detection {
  class: number; // index into the class names
  score: number; // 0…1
  // Pixels of the image, from edge to edge: the first pixel covers 0 to 1.
  x: number; y: number; width: number; height: number;
}

const STATES: State[] = ['initializing', 'tracking', 'lost'];
const DETECTION = 6; // numbers per detection
const READING = 7; // numbers per reading
const enum Bytes { Messages = 0, Trajectory = 1, Map = 2, Cloud = 3, InertialMissing = 4, InertialLeftOut = 5 }

// The numbers at an address of the module's memory.
function numbersAt<Name extends string>(core: Core, names: readonly Name[], at: number): Record<Name, number> {
  const numbers = new Float64Array(core.HEAPU8.buffer, at, names.length);
  return Object.fromEntries(names.map((name, i) => [name, numbers[i]!])) as Record<Name, number>;
}

const baseOf = ({ threads = 1, base }: Pick<SlamOptions, 'threads' | 'base'>) =>
  base ?? new URL(threads > 1 ? './threads/' : './single/', import.meta.url).href;
const keyOf = (options: Pick<SlamOptions, 'threads' | 'base'>) => `${options.threads ?? 1} ${baseOf(options)}`;

async function loadCore(options: Pick<SlamOptions, 'threads' | 'base' | 'wasmBinary'>): Promise<Core> {
  const { threads = 1, wasmBinary } = options;
  const base = baseOf(options);
  const module = await import(/* @vite-ignore */ base + 'alidade.mjs') as { default: CreateCore };
  return module.default({
    locateFile: (name) => base + name, threadPool: threads > 1 ? threads + STAGES : 1, ...(wasmBinary ? { wasmBinary } : {}),
  });
}

export type Picture = ImageData | Uint8Array | Uint8ClampedArray;

/** An error of the core, with its message. */
export class AlidadeError extends Error {
  override name = 'AlidadeError';
}

/**
 * Visual SLAM: images of one moving camera in, its pose and a map out. Call finish() after the last image: without it
 * the last adjustment and the poses of deferred localization are missing.
 */
export class Slam {
  static #warned = false; // of the order of version 0.1
  static #prepared = new Map<string, Promise<Core>>(); // modules that no session has yet
  /** Size of the images, pixels. */
  readonly width: number;
  readonly height: number;
  #core: Core;
  #session: number;
  #out: number; // four bytes for returned addresses

  private constructor(core: Core, session: number, width: number, height: number) {
    this.#core = core;
    this.#session = session;
    this.#out = core._malloc(4);
    this.width = width;
    this.height = height;
  }

  /**
   * Loads and compiles the core in advance; the next create() with the same `threads` and `base` then takes milliseconds.
   * Throws what import() and WebAssembly throw.
   */
  static async prepare(options: Pick<SlamOptions, 'threads' | 'base' | 'wasmBinary'> = {}): Promise<void> {
    const key = keyOf(options);
    const core = Slam.#prepared.get(key) ?? loadCore(options);
    Slam.#prepared.set(key, core);
    try {
      await core;
    } catch (error) {
      Slam.#prepared.delete(key); // create() tries again
      throw error;
    }
  }

  /** Loads the core and creates a session. Throws AlidadeError for invalid sizes, cameras and settings. */
  static async create(options: SlamOptions): Promise<Slam> {
    const threads = options.threads ?? 1;
    const prepared = Slam.#prepared.get(keyOf(options));
    Slam.#prepared.delete(keyOf(options));
    const core = await (prepared ?? loadCore(options));
    const { width, height } = options;
    if (!(Number.isInteger(width) && Number.isInteger(height) && width > 0 && height > 0 && width * height <= 1 << 26))
      throw new AlidadeError(`images of ${width}x${height} pixels are not possible`);
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

  /**
   * Processes one image: ImageData, or bytes with 4 (red green blue alpha) or 1 (gray) per pixel. `time` in seconds.
   * `imu`: readings of an inertial sensor since the last image, in order of time, 7 numbers each: time (seconds, on the
   * clock of the images or one with a constant offset below a second), angular rate x y z (rad/s) and specific force
   * x y z (m/s²; at rest it points up and is 9.81 long) in axes that are fixed to the camera. They may be ahead of the
   * image. How the sensor is mounted is found on the way. See inertial(). Throws AlidadeError.
   */
  track(time: number, picture: Picture, imu?: Float64Array): Frame;
  /** @deprecated The order of version 0.1, accepted in this version only. */
  track(picture: Picture, time: number): Frame;
  track(first: number | Picture, second: number | Picture, imu?: Float64Array): Frame {
    if (typeof first === 'number') return this.#track(first, second as Picture, imu);
    if (!Slam.#warned) console.warn('alidade: track(picture, time) is now track(time, picture)');
    Slam.#warned = true;
    return this.#track(second as number, first);
  }
  #track(time: number, picture: Picture, imu?: Float64Array): Frame {
    const core = this.#live();
    const bytes = 'data' in picture ? picture.data : picture;
    const channels = bytes.length / (this.width * this.height);
    if (channels !== 1 && channels !== 4)
      throw new AlidadeError(`an image of ${bytes.length} bytes is not one of ${this.width}x${this.height} pixels`);
    if (imu && imu.length > 0) this.#moved(core, imu);
    core.HEAPU8.set(bytes, core._alidade_pixels(this.#session));
    const at = core._alidade_track(this.#session, channels, time);
    if (at === 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
    const n = numbersAt(core, FRAME_NUMBERS, at);
    const pose: Pose = { position: [n.tx, n.ty, n.tz], orientation: [n.qx, n.qy, n.qz, n.qw] };
    const failure = FAILURES[n.failure - 1] ?? null; // 0: none
    return {
      number: n.number,
      state: STATES[n.state] ?? 'lost',
      pose: n.placed && !n.predicted ? pose : null,
      predicted: n.predicted ? pose : null,
      orientation: n.oriented
        ? { rotation: [n.ox, n.oy, n.oz, n.ow], tiltSigma: n.tiltSigma, headingSigma: n.headingSigma } : null,
      failure,
      reason: failure ? REASONS[failure] : '',
      counts: { keyframes: n.keyframes, landmarks: n.landmarks, matches: n.matches, features: n.features, maps: n.maps },
      milliseconds: n.milliseconds, fov: n.fov, fovSigma: n.fovSigma, cameraChanges: n.cameraChanges,
    };
  }

  /**
   * Passes the detections in an earlier image (Frame.number), which may be many images late. `found` may also be an
   * array of 6 numbers per detection, in the order of Detection's fields.
   */
  detected(number: number, found: readonly Detection[] | Float32Array): void {
    const core = this.#live();
    const numbers = found instanceof Float32Array ? found : Float32Array.from(found.flatMap((d) => [d.class, d.score, d.x, d.y, d.width, d.height]));
    const at = core._malloc(Math.max(4, numbers.byteLength));
    new Float32Array(core.HEAPU8.buffer, at, numbers.length).set(numbers);
    const told = core._alidade_detected(this.#session, number, at, Math.floor(numbers.length / DETECTION));
    core._free(at);
    if (told !== 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
  }

  /** What the readings passed to track() tell: meters, gravity, the clock of the sensor. */
  inertial(): Inertial {
    const core = this.#live();
    const at = core._alidade_inertial(this.#session);
    if (at === 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
    const n = numbersAt(core, INERTIAL_NUMBERS, at);
    const text = (what: Bytes) => new TextDecoder().decode(this.#bytes(what));
    return {
      samples: n.samples, metric: n.metric === 1, scaleSigma: n.scaleSigma, gravity: n.falls ? [n.gx, n.gy, n.gz] : null,
      gravitySigma: n.gravitySigma, timeOffset: n.timeOffset, timeOffsetSigma: n.timeOffsetSigma,
      missing: text(Bytes.InertialMissing), leftOut: text(Bytes.InertialLeftOut),
    };
  }

  /**
   * Covariance of the position of a landmark in the world (its id is in the messages), 3×3, map units² (meters² if
   * inertial().metric). It is of the landmark alone: of the difference of two, add both, and the scale's. Null: unknown.
   */
  landmarkCovariance(id: number): number[] | null {
    const core = this.#live();
    const at = core._alidade_covariance(this.#session, id);
    return at === 0 ? null : [...new Float64Array(core.HEAPU8.buffer, at, 9)];
  }

  /** The features of the last image. */
  features(): Feature[] {
    const core = this.#live();
    const count = core._alidade_features(this.#session, this.#out);
    const numbers = new Float32Array(core.HEAPU8.buffer, this.#address(core), 3 * count);
    return Array.from({ length: count }, (_, i) => ({ x: numbers[3 * i]!, y: numbers[3 * i + 1]!, matched: numbers[3 * i + 2] === 1 }));
  }

  /** The messages for the viewer since the previous call, as in run.stream. */
  messages(): Uint8Array[] {
    const all = this.#bytes(Bytes.Messages);
    const view = new DataView(all.buffer, all.byteOffset, all.byteLength);
    const messages: Uint8Array[] = [];
    for (let at = 0; at < all.length;) {
      const size = view.getUint32(at, true);
      messages.push(all.slice(at + 4, at + 4 + size)); // copies, so that each message is aligned
      at += 4 + size;
    }
    return messages;
  }

  /** All frames with a pose in TUM format: seconds, position, quaternion x y z w. */
  trajectory(): string { return new TextDecoder().decode(this.#bytes(Bytes.Trajectory)); }
  /** The bytes of map.alidade, for `alidade view` and `alidade run --load`. */
  map(): Uint8Array { return this.#bytes(Bytes.Map); }
  /** Landmarks as a binary PLY file. */
  cloud(): Uint8Array { return this.#bytes(Bytes.Cloud); }

  /** Completes pending work and adjusts the whole map once more. Returns trajectory(). */
  finish(): string {
    const core = this.#live();
    if (core._alidade_finish(this.#session) !== 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
    return this.trajectory();
  }

  /** Frees the session's memory; must be the last call. */
  delete(): void {
    if (this.#session === 0) return;
    this.#core._alidade_delete(this.#session);
    this.#core._free(this.#out);
    this.#session = 0;
  }

  #moved(core: Core, imu: Float64Array): void {
    if (imu.length % READING !== 0) throw new AlidadeError(`inertial readings have ${READING} numbers each: ${imu.length} are not a multiple`);
    const at = core._malloc(imu.byteLength);
    new Float64Array(core.HEAPU8.buffer, at, imu.length).set(imu);
    const told = core._alidade_moved(this.#session, at, imu.length / READING);
    core._free(at);
    if (told !== 0) throw new AlidadeError(core.UTF8ToString(core._alidade_error()));
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
