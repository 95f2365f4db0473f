// Encodes messages with flatc's builder, for tests and samples.
import * as flatbuffers from 'flatbuffers';
import * as fb from '../generated/stream_generated.ts';
import { FAILURES } from '../src/failures.ts';
import { EVENT_KINDS, STATES } from '../src/messages.ts';
import type { Frame, Hello, KeyFrame, MapChange, Message, Pose } from '../src/messages.ts';

type Builder = flatbuffers.Builder;
type Offset = flatbuffers.Offset;

const poseOf = (b: Builder, T: Pose) => fb.Pose.createPose(b, T[0], T[1], T[2], T[3], T[4], T[5], T[6]);

export function encode(message: Message): Uint8Array<ArrayBuffer> {
  const b = new flatbuffers.Builder(1024);
  const [type, body] = bodyOf(b, message);
  b.finish(fb.Message.createMessage(b, type, body), 'ALST');
  return new Uint8Array(b.asUint8Array());
}

function bodyOf(b: Builder, message: Message): [fb.Body, Offset] {
  switch (message.kind) {
    case 'hello': return [fb.Body.Hello, hello(b, message)];
    case 'frame': return [fb.Body.Frame, frame(b, message)];
    case 'map': return [fb.Body.MapChange, mapChange(b, message)];
    case 'event': {
      const text = b.createString(message.text);
      return [fb.Body.Event,
        fb.Event.createEvent(b, EVENT_KINDS.indexOf(message.what), message.number, message.time, text, message.a, message.b)];
    }
    case 'playback':
      return [fb.Body.Playback, fb.Playback.createPlayback(b, message.paused, message.finished, message.mayPause)];
  }
}

// Vectors of structs are built backwards.
function structs<T>(b: Builder, values: readonly T[], start: (b: Builder, n: number) => void, one: (value: T) => Offset): Offset {
  start(b, values.length);
  for (let i = values.length - 1; i >= 0; --i) one(values[i]);
  return b.endVector();
}

function bytes(b: Builder, values: ArrayBufferView): Offset {
  return fb.DepthCloud.createPointsVector(b, new Uint8Array(values.buffer, values.byteOffset, values.byteLength));
}

function hello(b: Builder, m: Hello): Offset {
  const strings = [m.program, m.source, m.sensor, m.unit].map((text) => b.createString(text));
  let camera = 0;
  if (m.camera) {
    const c = m.camera;
    const distortion = fb.Camera.createDistortionVector(b, c.distortion);
    // No rotation: not rectified.
    camera = fb.Camera.createCamera(b, c.width, c.height, c.fx, c.fy, c.cx, c.cy, distortion, c.baseline, 0);
  }
  const truth = structs(b, m.truth, fb.Hello.startTruthVector,
    ({ time, T_world_camera: T }) => fb.TruePose.createTruePose(b, time, T[0], T[1], T[2], T[3], T[4], T[5], T[6]));
  fb.Hello.startHello(b);
  fb.Hello.addVersion(b, m.version);
  fb.Hello.addProgram(b, strings[0]);
  fb.Hello.addSource(b, strings[1]);
  fb.Hello.addSensor(b, strings[2]);
  fb.Hello.addUnit(b, strings[3]);
  fb.Hello.addFrames(b, m.frames);
  fb.Hello.addLive(b, m.live);
  if (camera) fb.Hello.addCamera(b, camera);
  fb.Hello.addTruth(b, truth);
  return fb.Hello.endHello(b);
}

function frame(b: Builder, m: Frame): Offset {
  const cut = b.createString(m.cut);
  const ms = fb.Frame.createMsVector(b, m.ms);
  const features = bytes(b, m.features);
  const detections = fb.Frame.createDetectionsVector(b, m.detections.map((d) => {
    const label = b.createString(d.label);
    return fb.Detection.createDetection(b, d.x, d.y, d.width, d.height, d.score, label);
  }));
  const outlines = fb.Frame.createOutlinesVector(b, m.outlines.map(
    (o) => fb.Outline.createOutline(b, fb.Outline.createPointsVector(b, o))));
  let picture = 0;
  if (m.picture) {
    const type = b.createString(m.picture.type);
    const data = bytes(b, m.picture.bytes);
    picture = fb.Picture.createPicture(b, m.picture.width, m.picture.height, type, data);
  }
  fb.Frame.startFrame(b);
  fb.Frame.addNumber(b, m.number);
  fb.Frame.addTime(b, m.time);
  fb.Frame.addState(b, STATES.indexOf(m.state));
  fb.Frame.addFailure(b, m.failure ? FAILURES.indexOf(m.failure) + 1 : 0);
  fb.Frame.addCut(b, cut);
  fb.Frame.addKeyframe(b, m.keyframe);
  fb.Frame.addReference(b, m.reference);
  fb.Frame.addMap(b, m.map);
  if (m.T_reference_camera) fb.Frame.addTReferenceCamera(b, poseOf(b, m.T_reference_camera));
  if (m.T_world_camera) fb.Frame.addTWorldCamera(b, poseOf(b, m.T_world_camera));
  fb.Frame.addKeyframes(b, m.keyframes);
  fb.Frame.addLandmarks(b, m.landmarks);
  fb.Frame.addMatches(b, m.matches);
  fb.Frame.addMaps(b, m.maps);
  fb.Frame.addFoundShare(b, m.foundShare);
  fb.Frame.addMs(b, ms);
  fb.Frame.addFeatures(b, features);
  fb.Frame.addDetections(b, detections);
  fb.Frame.addOutlines(b, outlines);
  if (picture) fb.Frame.addPicture(b, picture);
  fb.Frame.addDetectionAge(b, m.detectionAge);
  return fb.Frame.endFrame(b);
}

function keyframe(b: Builder, k: KeyFrame): Offset {
  const covisible = fb.KeyFrame.createCovisibleVector(b, k.covisible);
  const loops = fb.KeyFrame.createLoopsVector(b, k.loops);
  fb.KeyFrame.startKeyFrame(b);
  fb.KeyFrame.addId(b, k.id);
  fb.KeyFrame.addMap(b, k.map);
  fb.KeyFrame.addParent(b, k.parent);
  fb.KeyFrame.addNumber(b, k.number);
  fb.KeyFrame.addTime(b, k.time);
  fb.KeyFrame.addTWorldCamera(b, poseOf(b, k.T_world_camera));
  fb.KeyFrame.addScale(b, k.scale);
  fb.KeyFrame.addCovisible(b, covisible);
  fb.KeyFrame.addLoops(b, loops);
  return fb.KeyFrame.endKeyFrame(b);
}

function mapChange(b: Builder, m: MapChange): Offset {
  const keyframes = fb.MapChange.createKeyframesVector(b, m.keyframes.map((k) => keyframe(b, k)));
  const moves = structs(b, m.moves, fb.MapChange.startMovesVector,
    ({ id, scale, T_world_camera: T }) => fb.Move.createMove(b, id, scale, T[0], T[1], T[2], T[3], T[4], T[5], T[6]));
  const landmarks = bytes(b, m.landmarks);
  const removed = fb.MapChange.createRemovedLandmarksVector(b, m.removedLandmarks);
  const culled = structs(b, m.culled, fb.MapChange.startCulledVector, ({ id, follows, scale, T_follows_culled: T }) =>
    fb.Culled.createCulled(b, id, follows, scale, T[0], T[1], T[2], T[3], T[4], T[5], T[6]));
  const depth = fb.MapChange.createDepthVector(b, m.depth.map((d) => {
    const points = bytes(b, d.points);
    return fb.DepthCloud.createDepthCloud(b, d.keyframe, d.least, d.most, points);
  }));
  const path = structs(b, m.path, fb.MapChange.startPathVector, ({ number, state, reference, time, T_reference_camera: T }) =>
    fb.PathFrame.createPathFrame(b, number, STATES.indexOf(state), reference, time, T[0], T[1], T[2], T[3], T[4], T[5], T[6]));
  const worlds = structs(b, m.worlds ?? [], fb.MapChange.startWorldsVector, ({ map, meters, scaleSigma, down, downSigma }) => {
    const [x, y, z] = down ?? [0, 0, 0];
    return fb.World.createWorld(b, map, meters, scaleSigma, x, y, z, downSigma);
  });
  fb.MapChange.startMapChange(b);
  fb.MapChange.addVersion(b, m.version);
  fb.MapChange.addWhole(b, m.whole);
  fb.MapChange.addKeyframes(b, keyframes);
  fb.MapChange.addMoves(b, moves);
  fb.MapChange.addLandmarks(b, landmarks);
  fb.MapChange.addRemovedLandmarks(b, removed);
  fb.MapChange.addCulled(b, culled);
  fb.MapChange.addDepth(b, depth);
  fb.MapChange.addPath(b, path);
  fb.MapChange.addTellsWorlds(b, m.worlds !== null);
  if (m.worlds) fb.MapChange.addWorlds(b, worlds);
  return fb.MapChange.endMapChange(b);
}
