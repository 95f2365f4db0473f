import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decode, DecodeError } from '../src/decode.ts';
import { History } from '../src/history.ts';
import type { Message } from '../src/messages.ts';
import { NONE } from '../src/messages.ts';
import { compose, inverse } from '../src/pose.ts';
import { State } from '../src/state.ts';
import { StreamFileReader } from '../src/stream_file.ts';
import { encode } from './encode.ts';
import { Sample } from './sample.ts';

const SMALL = { frames: 500, landmarks: 1500, depthPoints: 20, pictures: false };

function follow(sample: Sample, state: State): void {
  state.apply(decode(encode(sample.hello())));
  for (let i = 0; i < sample.frames; ++i) for (const message of sample.step(i)) state.apply(decode(encode(message)));
}

function near(a: readonly number[], b: readonly number[], bound: number, what: string): void {
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) <= bound, `${what}: ${a} is not ${b}`));
}

const ascending = (a: number, b: number) => a - b;

function assertSame(a: State, b: State): void {
  assert.deepEqual([...a.keyframes.keys()].sort(ascending), [...b.keyframes.keys()].sort(ascending));
  for (const [id, keyframe] of a.keyframes) assert.deepEqual(keyframe, b.keyframes.get(id));
  assert.equal(a.landmarks.size, b.landmarks.size);
  for (let i = 0; i < a.landmarks.size; ++i) {
    const one = a.landmarks.at(i);
    const other = b.landmarks.get(one.id)!;
    assert.equal(one.keyframe, other.keyframe);
    near(one.p, other.p, 1e-6, `landmark ${one.id}`); // anchored to another keyframe and rounded once more
  }
  assert.deepEqual([...a.clouds.keys()].sort(ascending), [...b.clouds.keys()].sort(ascending));
  for (const [id, cloud] of a.clouds) assert.deepEqual(cloud, b.clouds.get(id));
  assert.equal(a.path.length, b.path.length);
  for (let i = 0; i < a.path.length; ++i) {
    const [one, other] = [a.path.at(i), b.path.at(i)];
    near(one.T_reference_camera, other.T_reference_camera, 1e-12, `frame ${one.number}`);
    assert.deepEqual({ ...one, T_reference_camera: 0 }, { ...other, T_reference_camera: 0 });
  }
}

test('who saw every change and who joined at the end hold the same state', () => {
  const sample = new Sample(SMALL);
  const early = new State();
  follow(sample, early);
  const late = new State();
  late.apply(decode(encode(sample.hello())));
  late.apply(decode(encode(sample.whole())));
  assert.ok(early.keyframes.size > 20 && early.landmarks.size > 500);
  assert.ok(!early.incomplete && !late.incomplete);
  assertSame(early, late);
  for (const id of [...sample.points.keys()].filter((k) => k % 13 === 0)) near(early.landmarkInWorld(id)!, sample.worldOf(id), 1e-5, 'world');
});

test('keyframes culled in one message follow each other, in any order, and circles end', () => {
  for (const order of [[0, 1, 2], [2, 1, 0], [1, 2, 0]]) {
    const sample = new Sample({ ...SMALL, frames: 90 });
    const state = new State();
    follow(sample, state);
    const before = state.landmarkInWorld(state.landmarks.at(0).id)!;
    const ids = [...state.keyframes.keys()].slice(0, 4);
    const first = state.landmarks.at(0);
    assert.equal(first.keyframe, ids[0]);
    const culled = order.map((k) => {
      const [gone, next] = [state.keyframes.get(ids[k])!, state.keyframes.get(ids[k + 1])!];
      return moveTo(gone.id, gone, next);
    });
    state.apply({ ...sample.whole(), whole: false, keyframes: [], landmarks: new DataView(new ArrayBuffer(0)), depth: [], path: [], culled });
    assert.equal(state.landmarks.get(first.id)!.keyframe, ids[3]);
    near(state.landmarkInWorld(first.id)!, before, 1e-5, 'landmark');
  }
  const state = new State();
  const sample = new Sample({ ...SMALL, frames: 60 });
  follow(sample, state);
  const T_follows_culled = [0, 0, 0, 1, 0, 0, 0];
  const circle = [{ id: 0, follows: 1, scale: 1, T_follows_culled }, { id: 1, follows: 0, scale: 1, T_follows_culled }];
  state.apply({ ...sample.whole(), whole: false, keyframes: [], landmarks: new DataView(new ArrayBuffer(0)), depth: [], path: [], culled: circle });
  for (let i = 0; i < state.landmarks.size; ++i) assert.ok(state.landmarks.at(i).keyframe > 1);
});

test('a map that is gone takes its landmarks with it, not the frames that were seen', () => {
  const sample = new Sample({ ...SMALL, frames: 90 });
  const state = new State();
  follow(sample, state);
  const culled = [...state.keyframes.keys()].map((id) => ({ id, follows: NONE, scale: 1, T_follows_culled: [0, 0, 0, 1, 0, 0, 0] }));
  state.apply({ ...sample.whole(), whole: false, keyframes: [], landmarks: new DataView(new ArrayBuffer(0)), depth: [], path: [], culled });
  assert.equal(state.landmarks.size, 0);
  assert.equal(state.keyframes.size, 0);
  assert.equal(state.path.length, 90);
  assert.equal(state.path.at(50).reference, NONE);
  assert.equal(state.path.at(50).state, 'tracking');
});

test('a map change tells that lengths are meters and where down is, until another one does', () => {
  const sample = new Sample({ ...SMALL, frames: 30 });
  const state = new State();
  follow(sample, state);
  const empty = { ...sample.whole(), whole: false, keyframes: [], landmarks: new DataView(new ArrayBuffer(0)), depth: [], path: [], worlds: null };
  state.hello = { ...state.hello!, unit: 'map units' };
  state.apply(decode(encode({ ...empty, worlds: [] })));
  assert.equal(state.unit, 'map units');
  const known = { map: 0, meters: true, scaleSigma: 0.02, down: [0, 0.6, 0.8] as const, downSigma: 0.01 };
  state.apply(decode(encode({ ...empty, worlds: [{ ...known, map: 3 }] })));
  assert.equal(state.unit, 'map units'); // another map
  state.apply(decode(encode({ ...empty, worlds: [known] })));
  state.apply(decode(encode(empty)));
  assert.equal(state.unit, 'm');
  assert.deepEqual([...state.worlds.values()], [known]);
  state.apply(decode(encode({ ...empty, worlds: [] })));
  assert.equal(state.unit, 'map units');
  for (const wrong of [{ ...known, down: [0, 1, 1] as const }, { ...known, scaleSigma: NaN }, { ...known, downSigma: -1 }]) {
    assert.throws(() => decode(encode({ ...empty, worlds: [wrong] })), DecodeError);
  }
});

test('going back gives the state that was, from kept states and from whole ones', () => {
  for (const stride of [1, 200e3, 1e12]) {
    const history = new History({ budget: 1e12, stride, states: 20, events: 100, thinned: 10 });
    const live = new State();
    const copies = new Map<number, State>();
    for (const message of new Sample({ ...SMALL, frames: 300 }).messages()) {
      const bytes = encode(message);
      const index = history.add(bytes, message);
      live.apply(decode(bytes));
      history.keep(live);
      if (index % 37 === 0) copies.set(index, live.clone());
    }
    for (const [index, copy] of [...copies].reverse()) {
      const state = history.at(index);
      assertSame(state, copy);
      assert.equal(state.frame?.number, copy.frame?.number);
    }
  }
});

test('memory of the past is bounded: pictures go first, then the map in steps, then all', () => {
  const history = new History({ budget: 0.5e6, stride: 50e3, states: 20, events: 100, thinned: 10 });
  const live = new State();
  let index = 0;
  for (let round = 0; round < 4; ++round) {
    const sample = new Sample({ ...SMALL, frames: 400, pictures: round === 0, seed: round + 1 });
    for (const message of [sample.hello(), sample.whole(), ...[...Array(400).keys()].flatMap((i) => sample.step(i))] as Message[]) {
      const bytes = encode(message);
      index = history.add(bytes, message);
      live.apply(decode(bytes));
      history.keep(live);
      history.trim();
      assert.ok(history.size < 0.6e6, `${history.size}`);
    }
  }
  assert.ok(history.first > 0);
  assertSame(history.at(index), live);
  const middle = history.at(Math.floor((history.first + index) / 2));
  assert.ok(middle.keyframes.size > 0);
  history.at(history.first);
});

test('a recorded stream is read in pieces of any size, and its cut-off end told', () => {
  const messages = [...new Sample({ ...SMALL, frames: 20 }).messages()].map(encode);
  const parts: Uint8Array[] = [Buffer.from('ALIDSTR1')];
  for (const bytes of messages) {
    const head = new DataView(new ArrayBuffer(8));
    head.setUint32(0, bytes.length, true);
    parts.push(new Uint8Array(head.buffer), bytes, new Uint8Array((8 - (bytes.length % 8)) % 8));
  }
  const file = Buffer.concat([...parts, Buffer.from([1, 2, 3])]);
  for (const size of [1, 7, 1000, file.length]) {
    const reader = new StreamFileReader();
    const read: Uint8Array[] = [];
    for (let at = 0; at < file.length; at += size) read.push(...reader.push(new Uint8Array(file.subarray(at, at + size))));
    assert.equal(read.length, messages.length);
    read.forEach((bytes, i) => assert.deepEqual(bytes, messages[i]));
    assert.equal(reader.rest, 3);
  }
  assert.throws(() => new StreamFileReader().push(new Uint8Array(16)), /not a recorded stream/);
});

function moveTo(id: number, gone: { T_world_camera: readonly number[]; scale: number }, next: typeof gone & { id: number }) {
  const T = compose(inverse(next.T_world_camera), 1, gone.T_world_camera);
  return {
    id, follows: next.id, scale: gone.scale / next.scale,
    T_follows_culled: [...T.slice(0, 4), T[4] / next.scale, T[5] / next.scale, T[6] / next.scale],
  };
}

