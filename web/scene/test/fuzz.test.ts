// Damaged messages are rejected or read, but cause no other error: 100,000 modified messages of the sample.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decode, DecodeError } from '../src/decode.ts';
import { State } from '../src/state.ts';
import { StreamFileReader } from '../src/stream_file.ts';
import { encode } from './encode.ts';
import { Random, Sample } from './sample.ts';

const ROUNDS = 100000;
const SMALL = { frames: 120, landmarks: 60, depthPoints: 5, pictures: false };

const random = new Random(11);
const below = (count: number) => Math.floor(random.next() * count);
const seeds = [...new Sample(SMALL).messages()].map(encode);

// Critical values for lengths and offsets.
const EDGES = [0, 1, 2, 3, 4, 7, 8, 0x7f, 0x80, 0xff, 0x7fff, 0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xfffffffc, 0xffffffff];

function damaged(): Uint8Array {
  let bytes = seeds[below(seeds.length)].slice();
  if (random.next() < 0.2) bytes = bytes.slice(0, below(bytes.length));
  if (random.next() < 0.1) { // the beginning of one message and the rest of another
    const other = seeds[below(seeds.length)];
    const at = below(Math.min(bytes.length, other.length) + 1);
    bytes.set(other.subarray(at, bytes.length), Math.min(at, bytes.length));
  }
  if (bytes.length === 0) return bytes;
  const view = new DataView(bytes.buffer);
  for (let changes = 1 + below(4); changes > 0; --changes) {
    const near = Math.floor(random.next() ** 2 * bytes.length); // favor both ends, where tables and vtables are
    const at = random.next() < 0.5 ? near : bytes.length - 1 - near;
    const how = random.next();
    if (how < 0.4) bytes[at] = below(256);
    else if (how < 0.6) bytes[at] ^= 1 << below(8);
    else if (how < 0.8 && bytes.length >= 4) view.setUint32(Math.min(at & ~3, bytes.length - 4), EDGES[below(EDGES.length)], true);
    else if (bytes.length >= 2) view.setUint16(Math.min(at & ~1, bytes.length - 2), EDGES[below(EDGES.length)] & 0xffff, true);
  }
  return bytes;
}

// Returns whether DecodeError was thrown; rethrows any other error.
function refused(of: () => void): boolean {
  try {
    of();
    return false;
  } catch (error) {
    if (!(error instanceof DecodeError)) throw error;
    return true;
  }
}

test('no damaged message does anything but throw DecodeError, and what is read can be summed up', () => {
  let bad = 0;
  let state = new State();
  for (let round = 0; round < ROUNDS; ++round) {
    const bytes = damaged();
    if (refused(() => state.apply(decode(bytes)))) ++bad;
    if (round % 1000 === 999) { // use the state
      state.cameraPose();
      state.clone();
      state = new State();
      for (const seed of seeds.slice(0, 40)) state.apply(decode(seed));
    }
  }
  assert.ok(bad > 0.3 * ROUNDS && bad < 0.99 * ROUNDS, `${bad} of ${ROUNDS} refused`);
});

test('no damaged file does anything but throw DecodeError', () => {
  const parts: number[] = [...Buffer.from('ALIDSTR1')];
  for (const seed of seeds.slice(0, 12)) {
    parts.push(seed.length & 255, (seed.length >> 8) & 255, seed.length >> 16, 0, 0, 0, 0, 0, ...seed, ...Array<number>((8 - (seed.length % 8)) % 8).fill(0));
  }
  const whole = Uint8Array.from(parts);
  let bad = 0;
  for (let round = 0; round < 3000; ++round) {
    const file = whole.slice(0, random.next() < 0.3 ? below(whole.length) : whole.length);
    for (let changes = 1 + below(3); changes > 0 && file.length > 0; --changes) file[random.next() < 0.5 ? below(Math.min(64, file.length)) : below(file.length)] = below(256);
    const reader = new StreamFileReader();
    for (let at = 0; at < file.length;) {
      const size = 1 + below(4000);
      const stop = refused(() => {
        for (const message of reader.push(file.slice(at, at + size))) if (refused(() => decode(message))) ++bad;
      });
      if (stop) {
        ++bad;
        break;
      }
      at += size;
    }
  }
  assert.ok(bad > 500, `${bad} refused`);
});
