// Decodes bytes to a message. A pure function; malformed input throws DecodeError.
import * as flatbuffers from 'flatbuffers';
import * as fb from '../generated/stream_generated.ts';
import { failureWithReason, FAILURES, REASONS } from './failures.ts';
import { EVENT_KINDS, STATES } from './messages.ts';
import type { Camera, DepthCloud, Event, Failure, Frame, Hello, KeyFrame, MapChange, Message, Pose, World } from './messages.ts';
import { DecodeError, verify } from './verify.ts';

export { DecodeError } from './verify.ts';

export const VERSION = 1; // of the format; higher versions are rejected

// The message contains copies of the data. `bytes` may start at any offset; unaligned bytes are copied first, because
// FlatBuffers requires 8-byte alignment.
export function decode(bytes: Uint8Array): Message {
  const aligned = bytes.byteOffset % 8 === 0 ? bytes : bytes.slice();
  verify(aligned);
  const message = fb.Message.getRootAsMessage(new flatbuffers.ByteBuffer(aligned));
  const body = <T>(table: T): T => {
    if (message.body(table as never) === null) throw new DecodeError('an empty message');
    return table;
  };
  switch (message.bodyType()) {
    case fb.Body.Hello:
      return hello(body(new fb.Hello()));
    case fb.Body.Frame:
      return frame(body(new fb.Frame()));
    case fb.Body.MapChange:
      return mapChange(body(new fb.MapChange()));
    case fb.Body.Event:
      return event(body(new fb.Event()));
    case fb.Body.Playback: {
      const playback = body(new fb.Playback());
      return { kind: 'playback', paused: playback.paused(), finished: playback.finished(), mayPause: playback.mayPause() };
    }
    default:
      throw new DecodeError('an empty message');
  }
}

function list<From, To>(count: number, at: (i: number) => From | null, to: (from: From) => To): To[] {
  const result = new Array<To>(count);
  for (let i = 0; i < count; ++i) result[i] = to(at(i)!);
  return result;
}

function pose(p: fb.Pose): Pose {
  const values = [p.qx(), p.qy(), p.qz(), p.qw(), p.tx(), p.ty(), p.tz()];
  if (!values.every(Number.isFinite)) throw new DecodeError('a pose that is not a number');
  const norm = Math.hypot(values[0], values[1], values[2], values[3]);
  if (Math.abs(norm - 1) > 1e-3) throw new DecodeError(`a rotation whose quaternion has length ${norm}`);
  return values;
}

function finite(value: number, what: string): number {
  if (!Number.isFinite(value)) throw new DecodeError(`${what}: ${value}`);
  return value;
}

function scale(value: number): number {
  if (!(value > 0 && value < Infinity)) throw new DecodeError(`a scale of ${value}`);
  return value;
}

function entry<T>(names: readonly T[], value: number, what: string): T {
  if (value >= names.length) throw new DecodeError(`${what} ${value} is not known`);
  return names[value];
}

function records(bytes: Uint8Array | null, size: number, what: string): Uint8Array<ArrayBuffer> {
  if (bytes === null) return new Uint8Array(0);
  if (bytes.byteLength % size !== 0) throw new DecodeError(`${what}: ${bytes.byteLength} bytes are not records of ${size}`);
  return new Uint8Array(bytes); // a copy
}

function camera(c: fb.Camera): Camera {
  return {
    width: c.width(), height: c.height(), fx: c.fx(), fy: c.fy(), cx: c.cx(), cy: c.cy(),
    distortion: [...(c.distortionArray() ?? [])], baseline: c.baseline(),
  };
}

function hello(body: fb.Hello): Hello {
  if (body.version() > VERSION) {
    throw new DecodeError(`the stream is of version ${body.version()}, this page reads up to ${VERSION}: reload it, or update it`);
  }
  const from = body.camera();
  return {
    kind: 'hello', version: body.version(), program: body.program() ?? '', source: body.source() ?? '',
    sensor: body.sensor() ?? '', unit: body.unit() ?? '', frames: body.frames(), live: body.live(),
    camera: from && camera(from),
    truth: list(body.truthLength(), (i) => body.truth(i), (t) => ({ time: t.time(), T_world_camera: pose(t.tWorldCamera()!) })),
  };
}

function frame(body: fb.Frame): Frame {
  const inReference = body.tReferenceCamera();
  const inWorld = body.tWorldCamera();
  const picture = body.picture();
  return {
    kind: 'frame', number: body.number(), time: body.time(), state: entry(STATES, body.state(), 'state'),
    ...failure(body), cut: body.cut() ?? '', predicted: body.predicted(), keyframe: body.keyframe(),
    reference: body.reference(), map: body.map(),
    T_reference_camera: inReference && pose(inReference), T_world_camera: inWorld && pose(inWorld),
    keyframes: body.keyframes(), landmarks: body.landmarks(), matches: body.matches(), maps: body.maps(),
    foundShare: body.foundShare(), ms: [...(body.msArray() ?? [])],
    features: records(body.featuresArray(), 6, 'features'),
    detections: list(body.detectionsLength(), (i) => body.detections(i), (d) => ({
      x: finite(d.x(), 'a box'), y: finite(d.y(), 'a box'), width: finite(d.width(), 'a box'), height: finite(d.height(), 'a box'),
      score: finite(d.score(), 'a score'), label: d.label() ?? '',
    })),
    detectionAge: finite(body.detectionAge(), 'age of detections'),
    outlines: list(body.outlinesLength(), (i) => body.outlines(i), (o) => new Uint16Array(o.pointsArray() ?? [])),
    picture: picture && {
      width: picture.width(), height: picture.height(), type: picture.type() ?? '',
      bytes: new Uint8Array(picture.bytesArray() ?? []),
    },
  };
}

// Streams of Alidade 0.1 have words instead of the failure. Failures of later versions are shown without words.
function failure(body: fb.Frame): { failure: Failure | null; reason: string } {
  const told = FAILURES[body.failure() - 1];
  if (told) return { failure: told, reason: REASONS[told] };
  const words = body.reason() ?? '';
  return { failure: failureWithReason(words), reason: words };
}

function keyframe(k: fb.KeyFrame): KeyFrame {
  const at = k.tWorldCamera();
  if (!at) throw new DecodeError(`keyframe ${k.id()} without a pose`);
  return {
    id: k.id(), map: k.map(), parent: k.parent(), number: k.number(), time: k.time(),
    T_world_camera: pose(at), scale: scale(k.scale()),
    covisible: [...(k.covisibleArray() ?? [])], loops: [...(k.loopsArray() ?? [])],
  };
}

function cloud(d: fb.DepthCloud): DepthCloud {
  const least = d.least();
  const most = d.most();
  const points = new Uint16Array(records(d.pointsArray(), 8, 'depth').buffer);
  if (points.length > 0 && !(least > 0 && most >= least && most < Infinity)) {
    throw new DecodeError(`depth of keyframe ${d.keyframe()} between inverse depths ${least} and ${most}`);
  }
  return { keyframe: d.keyframe(), least, most, points };
}

function sigma(value: number, what: string): number {
  if (!(value >= 0 && value < Infinity)) throw new DecodeError(`the standard deviation of ${what}: ${value}`);
  return value;
}

function world(w: fb.World): World {
  const down = [w.downX(), w.downY(), w.downZ()] as const;
  const known = down.some((value) => value !== 0);
  if (known && !(Math.abs(Math.hypot(...down) - 1) < 1e-6)) throw new DecodeError('a direction of gravity that is not a unit vector');
  return {
    map: w.map(), meters: w.meters(), scaleSigma: sigma(w.scaleSigma(), 'a scale'), down: known ? down : null,
    downSigma: sigma(w.downSigma(), 'gravity'),
  };
}

function mapChange(body: fb.MapChange): MapChange {
  return {
    kind: 'map', version: body.version(), whole: body.whole(),
    keyframes: list(body.keyframesLength(), (i) => body.keyframes(i), keyframe),
    moves: list(body.movesLength(), (i) => body.moves(i), (m) => ({
      id: m.id(), scale: scale(m.scale()), T_world_camera: pose(m.tWorldCamera()!),
    })),
    landmarks: new DataView(records(body.landmarksArray(), 20, 'landmarks').buffer),
    removedLandmarks: new Uint32Array(body.removedLandmarksArray() ?? []),
    culled: list(body.culledLength(), (i) => body.culled(i), (c) => ({
      id: c.id(), follows: c.follows(), scale: scale(c.scale()), T_follows_culled: pose(c.tFollowsCulled()!),
    })),
    depth: list(body.depthLength(), (i) => body.depth(i), cloud),
    path: list(body.pathLength(), (i) => body.path(i), (p) => ({
      number: p.number(), time: p.time(), state: entry(STATES, p.state(), 'state'), reference: p.reference(),
      T_reference_camera: pose(p.tReferenceCamera()!),
    })),
    worlds: body.tellsWorlds() ? list(body.worldsLength(), (i) => body.worlds(i), world) : null,
  };
}

function event(body: fb.Event): Event {
  return {
    kind: 'event', what: entry(EVENT_KINDS, body.kind(), 'event'), number: body.number(), time: body.time(),
    text: body.text() ?? '', a: body.a(), b: body.b(),
  };
}
