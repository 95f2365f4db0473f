// A synthetic stream: a camera moves twice around a room; its map drifts until a loop closes; keyframes and landmarks
// are culled; it is lost for a while in front of a white sheet. World: x right, y down, z forward of the first
// keyframe.
import type { Culled, DepthCloud, Frame, KeyFrame, MapChange, Message, PathFrame, Pose, World } from '../src/messages.ts';
import { REASONS } from '../src/failures.ts';
import { NONE } from '../src/messages.ts';
import { compose, inverse, rotate, transform } from '../src/pose.ts';
import { encode } from './encode.ts';
import { png } from './png.ts';

export interface SampleSettings {
  frames?: number;
  every?: number; // frames between keyframes
  landmarks?: number; // number in the whole room
  depthPoints?: number; // number per keyframe
  pictures?: boolean;
  seed?: number;
}

const WIDTH = 320, HEIGHT = 240, FOCAL = 260;
const ROOM = { x: 3, y: 1.4, z: 4 }; // half sizes, meters
const CAMERA = { width: WIDTH, height: HEIGHT, fx: FOCAL, fy: FOCAL, cx: 159.5, cy: 119.5, distortion: [0, 0, 0, 0, 0], baseline: 0 };

export class Random { // mulberry32
  constructor(private state: number) {}
  next(): number {
    let t = (this.state += 0x6d2b79f5);
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  }
}

const about = (axis: 0 | 1 | 2, angle: number): Pose => {
  const q = [0, 0, 0, Math.cos(angle / 2), 0, 0, 0];
  q[axis] = Math.sin(angle / 2);
  return q;
};

// Camera pose in the room; a full round is `turn` = 1.
function roomPose(turn: number): Pose {
  const angle = 2 * Math.PI * turn;
  const at: Pose = [0, 0, 0, 1, 1.5 * Math.sin(angle), 0.15 * Math.sin(3 * angle), -2 * Math.cos(angle) + 0.1];
  return compose(compose(at, 1, about(1, angle * 0.999 + 0.5)), 1, about(0, 0.12 * Math.sin(2 * angle)));
}

interface Point { id: number; room: [number, number, number]; keyframe: number; p: [number, number, number] }

export class Sample {
  readonly frames: number;
  readonly keyframes = new Map<number, KeyFrame>();
  readonly points = new Map<number, Point>(); // landmarks of the map
  readonly clouds = new Map<number, DepthCloud>();
  readonly path: PathFrame[] = [];
  readonly events: Message[] = []; // so far
  worlds: World[] = []; // known from the closed loop on
  told: Frame | null = null; // the last one
  private readonly room: [number, number, number][] = [];
  private readonly inMap = new Map<number, number>(); // room point → landmark
  private readonly truth: Pose[] = [];
  private readonly random: Random;
  private readonly settings: Required<SampleSettings>;
  private version = 0n;
  private drift: Pose = [0, 0, 0, 1, 0, 0, 0]; // T_map_world
  private last = NONE;
  private nextLandmark = 0;
  private closed = false;

  constructor(settings: SampleSettings = {}) {
    this.settings = { frames: 900, every: 12, landmarks: 4000, depthPoints: 1500, pictures: true, seed: 1, ...settings };
    this.frames = this.settings.frames;
    this.random = new Random(this.settings.seed);
    for (let i = 0; i < this.settings.landmarks; ++i) this.room.push(this.onWall());
    const start = inverse(roomPose(0));
    for (let i = 0; i < this.frames; ++i) this.truth.push(compose(start, 1, roomPose((2 * i) / this.frames)));
  }

  hello(): Message {
    const truth = this.truth.map((T_world_camera, i) => ({ time: i / 30, T_world_camera }));
    return {
      kind: 'hello', version: 1, program: 'alidade 0.2.0', source: 'synth:room --frames ' + this.frames, sensor: 'rgbd', unit: 'm',
      frames: this.frames, live: false, camera: CAMERA, truth,
    };
  }

  // The whole state, for a client that joins now.
  whole(): MapChange {
    return {
      kind: 'map', version: this.version, whole: true, keyframes: [...this.keyframes.values()], moves: [],
      landmarks: packLandmarks([...this.points.values()]), removedLandmarks: new Uint32Array(0), culled: [],
      depth: [...this.clouds.values()], path: [...this.path], worlds: this.worlds,
    };
  }

  // Messages of frame i, in order.
  step(i: number): Message[] {
    const messages: Message[] = []; // events
    const share = i / this.frames;
    const lost = share > 0.3 && share < 0.34;
    const waiting = i < 8;
    const event = (what: Extract<Message, { kind: 'event' }>['what'], text: string, a = NONE, b = NONE) =>
      messages.push({ kind: 'event', what, number: i, time: i / 30, text, a, b });
    if (i === 0) event('waiting', REASONS.little_motion);
    if (i === 8) event('started', 'map 0 begins');
    if (!lost && !waiting) this.drift = compose(this.drift, 1, [...about(1, this.closed ? 0 : 0.00035).slice(0, 4), 0.0006, 0, 0]);
    const T_world_camera = compose(this.drift, 1, this.truth[i]);
    const keyframe = !lost && !waiting && (i - 8) % this.settings.every === 0;
    const change = this.emptyChange();
    let fresh = new Set<number>();
    if (keyframe) fresh = this.addKeyFrame(i, T_world_camera, change);
    if (share >= 0.3 && share < 0.3 + 1 / this.frames) event('lost', 'too few landmarks found');
    if (share >= 0.34 && share < 0.34 + 1 / this.frames) event('found', 'recognised by keyframe 3', 3);
    if (keyframe && !this.closed && share > 0.52) {
      this.closeLoop(change);
      change.worlds = this.worlds = [{ map: 0, meters: true, scaleSigma: 0.01, down: null, downSigma: 0 }];
      event('loop', 'keyframes 0 and ' + this.last, 0, this.last);
    }
    if (i === this.frames - 1) event('finished', '');
    this.events.push(...messages);
    const frame = this.told = this.frame(i, lost ? 'lost' : waiting ? 'initializing' : 'tracking', keyframe, fresh);
    return [...(keyframe ? [change] : []), ...messages, frame];
  }

  *messages(): Generator<Message> {
    yield this.hello();
    yield { kind: 'playback', paused: false, finished: false, mayPause: true };
    for (let i = 0; i < this.frames; ++i) {
      yield* this.step(i);
      if (i % 300 === 299) {
        yield this.whole();
        yield* this.events;
      }
    }
    yield { kind: 'playback', paused: false, finished: true, mayPause: true };
  }

  worldOf(id: number): [number, number, number] {
    const point = this.points.get(id)!;
    const keyframe = this.keyframes.get(point.keyframe)!;
    return transform(keyframe.T_world_camera, keyframe.scale, ...point.p);
  }

  private onWall(): [number, number, number] {
    const side = Math.floor(this.random.next() * 5);
    const [a, b] = [2 * this.random.next() - 1, 2 * this.random.next() - 1];
    const { x, y, z } = ROOM;
    if (side === 0) return [x, b * y, a * z];
    if (side === 1) return [-x, b * y, a * z];
    if (side === 2) return [a * x, b * y, z];
    if (side === 3) return [a * x, b * y, -z];
    return [a * x, y, b * z];
  }

  private emptyChange(): MapChange {
    return {
      kind: 'map', version: ++this.version, whole: false, keyframes: [], moves: [], landmarks: new DataView(new ArrayBuffer(0)),
      removedLandmarks: new Uint32Array(0), culled: [], depth: [], path: [], worlds: null,
    };
  }

  private addKeyFrame(i: number, T_world_camera: Pose, change: MapChange): Set<number> {
    const id = this.last === NONE ? 0 : this.last + 1;
    const ids = [...this.keyframes.keys()];
    const scale = 1 + 0.02 * (id % 5);
    const keyframe: KeyFrame = {
      id, map: 0, parent: this.last, number: i, time: i / 30, T_world_camera, scale, covisible: ids.slice(-4), loops: [],
    };
    this.keyframes.set(id, keyframe);
    this.last = id;
    change.keyframes.push(keyframe);
    const fresh: Point[] = [];
    for (const [at, pixel] of this.visible(this.truth[i], 260)) {
      if (this.inMap.has(at) || pixel === null) continue;
      const inCamera = transform(inverse(compose(inverse(roomPose(0)), 1, roomPose((2 * i) / this.frames))), 1, ...this.inWorld(at));
      const noise = () => 0.012 * (this.random.next() - 0.5);
      const p = inCamera.map((value) => Math.fround((value + noise()) / scale)) as [number, number, number];
      const point = { id: this.nextLandmark++, room: this.room[at], keyframe: id, p };
      this.points.set(point.id, point);
      this.inMap.set(at, point.id);
      fresh.push(point);
    }
    change.landmarks = packLandmarks(fresh);
    const removed = fresh.filter((_, n) => n % 17 === 5).map((point) => point.id - 40).filter((old) => this.points.has(old));
    for (const old of removed) this.points.delete(old);
    change.removedLandmarks = new Uint32Array(removed);
    const old = id - 3;
    if (this.keyframes.has(old)) {
      const cloud = this.depthOf(old);
      this.clouds.set(old, cloud);
      change.depth.push(cloud);
    }
    if (id > 8 && id % 4 === 2) this.cull(id - 5, change);
    return new Set(fresh.map((point) => point.id));
  }

  private cull(id: number, change: MapChange): void {
    const gone = this.keyframes.get(id);
    const follows = gone && this.keyframes.get(gone.parent === NONE || !this.keyframes.has(gone.parent) ? id - 1 : gone.parent);
    if (!gone || !follows) return;
    const T = compose(inverse(follows.T_world_camera), 1, gone.T_world_camera);
    const T_follows_culled = [...T.slice(0, 4), T[4] / follows.scale, T[5] / follows.scale, T[6] / follows.scale];
    const one: Culled = { id, follows: follows.id, scale: gone.scale / follows.scale, T_follows_culled };
    this.keyframes.delete(id);
    this.clouds.delete(id);
    for (const point of this.points.values()) {
      if (point.keyframe !== id) continue;
      point.keyframe = follows.id;
      point.p = transform(T_follows_culled, one.scale, ...point.p).map(Math.fround) as [number, number, number];
    }
    for (const frame of this.path) {
      if (frame.reference !== id) continue;
      frame.reference = follows.id;
      frame.T_reference_camera = compose(T_follows_culled, one.scale, frame.T_reference_camera);
    }
    for (const [other, keyframe] of this.keyframes) {
      if (!keyframe.covisible.includes(id) && keyframe.parent !== id) continue;
      const changed = {
        ...keyframe, covisible: keyframe.covisible.filter((k) => k !== id), parent: keyframe.parent === id ? follows.id : keyframe.parent,
      };
      this.keyframes.set(other, changed);
      change.keyframes.push(changed);
    }
    change.depth = change.depth.filter((cloud) => cloud.keyframe !== id);
    change.culled.push(one);
  }

  // Distributes the drift over the keyframes and removes it.
  private closeLoop(change: MapChange): void {
    this.closed = true;
    const back = inverse(this.drift);
    for (const [id, keyframe] of this.keyframes) {
      const share = id / this.last;
      const part = [0, back[1] * share, 0, 1, back[4] * share, back[5] * share, back[6] * share];
      const norm = Math.hypot(part[1], 1);
      part[1] /= norm;
      part[3] /= norm;
      const moved = { ...keyframe, T_world_camera: compose(part, 1, keyframe.T_world_camera), scale: keyframe.scale * (1 + 0.001 * share) };
      this.keyframes.set(id, moved);
      change.moves.push({ id, scale: moved.scale, T_world_camera: moved.T_world_camera });
    }
    this.drift = [0, 0, 0, 1, 0, 0, 0];
    for (const [id, other] of [[0, this.last], [this.last, 0]]) {
      const linked = { ...this.keyframes.get(id)!, loops: [other] };
      this.keyframes.set(id, linked);
      change.keyframes = change.keyframes.filter((k) => k.id !== id);
      change.keyframes.push(linked);
    }
  }

  private inWorld(at: number): [number, number, number] {
    return transform(inverse(roomPose(0)), 1, ...this.room[at]);
  }

  private *visible(T_world_camera: Pose, most: number): Generator<[number, [number, number]]> {
    const T_camera_world = inverse(T_world_camera);
    let count = 0;
    for (let at = 0; at < this.room.length && count < most; ++at) {
      const [x, y, z] = transform(T_camera_world, 1, ...this.inWorld(at));
      if (z < 0.1) continue;
      const [u, v] = [(FOCAL * x) / z + CAMERA.cx, (FOCAL * y) / z + CAMERA.cy];
      if (u < 0 || v < 0 || u > WIDTH - 1 || v > HEIGHT - 1) continue;
      ++count;
      yield [at, [u, v]];
    }
  }

  // Distance to the wall along a ray, and the wall's color there.
  private cast(o: readonly number[], d: readonly number[]): [number, number, number, number] {
    let t = Infinity;
    let axis = 0;
    [ROOM.x, ROOM.y, ROOM.z].forEach((half, k) => {
      const at = ((d[k] > 0 ? half : -half) - o[k]) / d[k];
      if (at > 0 && at < t) [t, axis] = [at, k];
    });
    const p = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
    const [a, b] = axis === 0 ? [p[1], p[2]] : axis === 1 ? [p[0], p[2]] : [p[0], p[1]];
    const tile = (Math.floor(a * 2) + Math.floor(b * 2)) & 1;
    const base = [[168, 120, 92], [110, 112, 118], [96, 128, 150]][axis];
    const light = (tile ? 1 : 0.72) / (1 + 0.05 * t);
    return [t, base[0] * light, base[1] * light, base[2] * light];
  }

  private depthOf(id: number): DepthCloud {
    const keyframe = this.keyframes.get(id)!;
    const T_room_camera = compose(roomPose(0), 1, this.truth[keyframe.number]);
    const points = new Uint16Array(4 * this.settings.depthPoints);
    const [least, most] = [0.1, 5];
    for (let n = 0; n < this.settings.depthPoints; ++n) {
      const [x, y] = [Math.floor(this.random.next() * 65536), Math.floor(this.random.next() * 65536)];
      const u = (x * WIDTH) / 65536 - 0.5, v = (y * HEIGHT) / 65536 - 0.5;
      const ray = rotate(T_room_camera, (u - CAMERA.cx) / FOCAL, (v - CAMERA.cy) / FOCAL, 1);
      const [t, r, g, b] = this.cast(T_room_camera.slice(4), ray);
      const inverseDepth = keyframe.scale / t;
      const depth = Math.round((65535 * Math.log(inverseDepth / least)) / Math.log(most / least));
      points.set([x, y, Math.max(0, Math.min(65535, depth)), ((r >> 3) << 11) | ((g >> 2) << 5) | (b >> 3)], 4 * n);
    }
    return { keyframe: id, least, most, points };
  }

  private frame(i: number, state: Frame['state'], keyframe: boolean, fresh: ReadonlySet<number>): Frame {
    const T_world_camera = compose(this.drift, 1, this.truth[i]);
    const tracking = state === 'tracking';
    let reference = NONE;
    let T_reference_camera: Pose | null = null;
    if (tracking) {
      reference = this.last;
      const { T_world_camera: T, scale } = this.keyframes.get(reference)!;
      const relative = compose(inverse(T), 1, T_world_camera);
      T_reference_camera = [...relative.slice(0, 4), relative[4] / scale, relative[5] / scale, relative[6] / scale];
    }
    this.path.push({ number: i, time: i / 30, state, reference, T_reference_camera: T_reference_camera ?? [0, 0, 0, 1, 0, 0, 0] });
    const features: number[] = [];
    let matches = 0;
    if (state !== 'lost') {
      for (const [at, [u, v]] of this.visible(this.truth[i], 300)) {
        const id = this.inMap.get(at);
        const known = id !== undefined && this.points.has(id);
        const moving = u > 215 && u < 285 && v > 70 && i % 200 > 100;
        const use = moving ? 3 : !known ? 0 : fresh.has(id) ? 2 : 1;
        if (use === 1) ++matches;
        features.push(Math.round(((u + 0.5) / WIDTH) * 65536), Math.round(((v + 0.5) / HEIGHT) * 65536), use, moving ? 20 : 240);
      }
    }
    const packed = new DataView(new ArrayBuffer((features.length / 4) * 6));
    for (let n = 0; n < features.length / 4; ++n) {
      packed.setUint16(6 * n, features[4 * n], true);
      packed.setUint16(6 * n + 2, features[4 * n + 1], true);
      packed.setUint8(6 * n + 4, features[4 * n + 2]);
      packed.setUint8(6 * n + 5, features[4 * n + 3]);
    }
    const someone = i % 200 > 100;
    const ms = (mean: number, share = 0.3) => mean * (1 + share * (this.random.next() - 0.5));
    const track = ms(3), extract = ms(5);
    const failure = state === 'lost' ? 'few_landmarks' : state === 'initializing' ? 'low_parallax' : null;
    return {
      kind: 'frame', number: i, time: i / 30, state, cut: '', predicted: false, keyframe,
      failure, reason: failure ? REASONS[failure] : '',
      reference, map: tracking ? 0 : NONE, T_reference_camera, T_world_camera: tracking ? T_world_camera : null,
      keyframes: this.keyframes.size, landmarks: this.points.size, matches: tracking ? matches : 0, maps: this.keyframes.size ? 1 : 0,
      foundShare: tracking ? 0.8 : 0, ms: [track + extract + 1, extract, track, keyframe ? ms(22) : -1, -1, keyframe ? ms(30) : -1, -1, -1],
      features: new Uint8Array(packed.buffer),
      detections: someone ? [{ x: 215, y: 66, width: 72, height: 168, score: 0.83, label: 'person' }] : [],
      detectionAge: someone ? 0.25 : i % 200 > 20 ? 0 : -1,
      outlines: someone ? [ellipse(251, 150, 34, 82)] : [],
      picture: this.settings.pictures ? this.picture(i, state === 'lost', someone) : null,
    };
  }

  private picture(i: number, blank: boolean, someone: boolean): Frame['picture'] {
    const [w, h] = [160, 120];
    const rows = new Uint8Array(h * (1 + 3 * w));
    const T_room_camera = compose(roomPose(0), 1, this.truth[i]);
    const o = T_room_camera.slice(4);
    for (let y = 0; y < h; ++y) {
      for (let x = 0; x < w; ++x) {
        const at = y * (1 + 3 * w) + 1 + 3 * x;
        if (blank) {
          rows.fill(225, at, at + 3);
          continue;
        }
        const [u, v] = [2 * x + 0.5, 2 * y + 0.5];
        const inside = someone && ((u - 251) / 30) ** 2 + ((v - 150) / 78) ** 2 < 1;
        const [, r, g, b] = inside ? [0, 70, 52, 96] : this.cast(o, rotate(T_room_camera, (u - CAMERA.cx) / FOCAL, (v - CAMERA.cy) / FOCAL, 1));
        rows.set([r, g, b], at);
      }
    }
    return { width: w, height: h, type: 'image/png', bytes: png(w, h, rows) };
  }
}

export function* sampleStream(settings?: SampleSettings): Generator<Uint8Array<ArrayBuffer>> {
  for (const message of new Sample(settings).messages()) yield encode(message);
}

function ellipse(x: number, y: number, a: number, b: number): Uint16Array {
  return Uint16Array.from({ length: 48 }, (_, k) => {
    const angle = (2 * Math.PI * Math.floor(k / 2)) / 24;
    return k % 2 === 0 ? ((x + a * Math.cos(angle) + 0.5) / WIDTH) * 65536 : ((y + b * Math.sin(angle) + 0.5) / HEIGHT) * 65536;
  });
}

function packLandmarks(points: readonly Point[]): DataView {
  const view = new DataView(new ArrayBuffer(20 * points.length));
  points.forEach(({ id, keyframe, p }, i) => {
    view.setUint32(20 * i, id, true);
    view.setUint32(20 * i + 4, keyframe, true);
    p.forEach((value, k) => view.setFloat32(20 * i + 8 + 4 * k, value, true));
  });
  return view;
}
