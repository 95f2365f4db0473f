import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import * as flatbuffers from 'flatbuffers';
import * as fb from '../generated/stream_generated.ts';
import { decode, DecodeError } from '../src/decode.ts';
import { failureWithReason, FAILURES, REASONS } from '../src/failures.ts';
import type { Message } from '../src/messages.ts';
import { encode } from './encode.ts';
import { Sample } from './sample.ts';

declare const WEB: string;

const SMALL = { frames: 120, landmarks: 600, depthPoints: 40, pictures: false };

test('what is encoded is decoded, whatever message it is', () => {
  const kinds = new Set<string>();
  for (const message of new Sample(SMALL).messages()) {
    const back = decode(encode(message));
    kinds.add(back.kind);
    assert.deepEqual(comparable(back), comparable(message));
  }
  assert.deepEqual([...kinds].sort(), ['event', 'frame', 'hello', 'map', 'playback']);
});

test('a message may start at any byte of its buffer', () => {
  const sample = new Sample(SMALL);
  sample.step(0);
  const message = sample.hello();
  const bytes = encode(message);
  for (let shift = 0; shift < 8; ++shift) {
    const shifted = new Uint8Array(bytes.length + shift);
    shifted.set(bytes, shift);
    assert.deepEqual(decode(shifted.subarray(shift)), message);
  }
});

test('a stream of a later version is refused, with the reason', () => {
  const hello = { ...new Sample(SMALL).hello(), version: 2 } as Message;
  assert.throws(() => decode(encode(hello)), (error: Error) => error instanceof DecodeError && /version 2/.test(error.message));
});

test('many offsets to the same bytes do not make a small message a large one', () => {
  const keyframes = [...Array(2000).keys()].map((id) => ({
    id, map: 0, parent: 0, number: 0, time: 0, T_world_camera: [0, 0, 0, 1, 0, 0, 0], scale: 1, covisible: id === 0 ? Array(20000).fill(1) : [], loops: [],
  }));
  const sample = new Sample(SMALL);
  const bytes = encode({ ...sample.whole(), keyframes });
  decode(bytes);
  // Let all 2000 elements of the vector refer to the keyframe with the long list.
  const view = new DataView(bytes.buffer);
  const at = vectorOf(view, 2000);
  const long = [...Array(2000).keys()].map((i) => at + 4 + 4 * i + view.getUint32(at + 4 + 4 * i, true)).find((table) => hasLongList(view, table))!;
  for (let i = 0; i < 2000; ++i) view.setUint32(at + 4 + 4 * i, long - (at + 4 + 4 * i), true);
  assert.throws(() => decode(bytes), DecodeError);
});

function vectorOf(view: DataView, count: number): number {
  for (let at = 8; at + 4 + 4 * count <= view.byteLength; at += 4) if (view.getUint32(at, true) === count) return at;
  throw new Error('no such vector');
}

function hasLongList(view: DataView, table: number): boolean {
  const vtable = table - view.getInt32(table, true);
  if (view.getUint16(vtable, true) < 20) return false;
  const offset = view.getUint16(vtable + 4 + 2 * 7, true);
  if (!offset) return false;
  const vector = table + offset + view.getUint32(table + offset, true);
  return view.getUint32(vector, true) === 20000;
}

// Floats are sent as float32.
function comparable(message: Message): unknown {
  const round = (value: unknown): unknown => {
    if (value instanceof DataView) return [...new Uint8Array(value.buffer)];
    if (typeof value === 'number') return Math.fround(value);
    if (ArrayBuffer.isView(value)) return [...(value as Uint8Array)];
    if (Array.isArray(value)) return value.map(round);
    if (value && typeof value === 'object') return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, round(v)]));
    return value;
  };
  return round(message);
}

// A frame message of Alidade 0.1: words, no failure.
function oldFrame(reason: string): Uint8Array {
  const b = new flatbuffers.Builder(256);
  const words = b.createString(reason);
  fb.Frame.startFrame(b);
  fb.Frame.addState(b, fb.State.lost);
  fb.Frame.addReason(b, words);
  const frame = fb.Frame.endFrame(b);
  fb.Message.startMessage(b);
  fb.Message.addBodyType(b, fb.Body.Frame);
  fb.Message.addBody(b, frame);
  fb.Message.finishMessageBuffer(b, fb.Message.endMessage(b));
  return b.asUint8Array().slice();
}

test('a stream of 0.1, which has words only, is still shown', () => {
  const told = (reason: string) => {
    const message = decode(oldFrame(reason));
    assert.ok(message.kind === 'frame');
    return [message.failure, message.reason];
  };
  assert.deepEqual(told('the camera hardly moves'), ['little_motion', 'the camera hardly moves']);
  assert.deepEqual(told('the place was not recognised'), ['not_recognized', 'the place was not recognised']);
  assert.deepEqual(told('words that nobody knows'), [null, 'words that nobody knows']);
  assert.deepEqual(told(''), [null, '']);
});

test('failures and their words are those of the C++ sources, in the order of the stream', () => {
  const read = (path: string) => readFileSync(join(WEB, '../src/alidade', path), 'utf8');
  const ids = Object.values(fb.Failure).filter((name) => typeof name === 'string');
  assert.deepEqual(ids, ['none', ...FAILURES]);
  const cc = read('tracking/track_failure.cc');
  const returned = [...cc.matchAll(/return "([^"]+)";/g)].map(([, words]) => words);
  assert.deepEqual(FAILURES.map((failure) => REASONS[failure]), returned);
  const header = read('tracking/track_failure.h');
  assert.equal(FAILURES.length + 1, Number(/kTrackFailures = (\d+)/.exec(header)![1]));
  for (const failure of FAILURES) assert.equal(failureWithReason(REASONS[failure]), failure);
});
