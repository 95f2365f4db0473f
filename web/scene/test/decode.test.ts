import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decode, DecodeError } from '../src/decode.ts';
import type { Message } from '../src/messages.ts';
import { encode } from './encode.ts';
import { Sample } from './sample.ts';

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
