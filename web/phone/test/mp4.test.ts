// The index of MP4 files, made for the test: places, times, edit lists, rotation; a large file is not read.
import assert from 'node:assert/strict';
import * as fs from 'node:fs';
import { closeSync, mkdtempSync, openSync, rmSync, writeSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { readMp4 } from '../src/mp4.ts';
import { FTYP, index, longMdat, mp4File, TICKS } from './mp4_file.ts';
import type { Layout, Sample } from './mp4_file.ts';

const { openAsBlob } = fs as unknown as { openAsBlob?: (file: string) => Promise<Blob> }; // Node 20
const AVC = Uint8Array.of(1, 0x4d, 0x40, 0x1e, 0xff, 0xe0, 0); // Main profile, level 3.0, no parameter sets
const LAYOUT: Layout = { width: 640, height: 360, entry: 'avc1', configuration: AVC };
const sample = (length: number, key = false, delay = 0): Sample => ({ data: new Uint8Array(length), key, delay });
// Shown in the order 0 2 3 1, 1 tick after they are decoded.
const SAMPLES = [sample(100, true, 1), sample(50, false, 3), sample(20, false, 0), sample(30, false, 0)];
const of = (layout: Partial<Layout> = {}, samples: readonly Sample[] = SAMPLES) => readMp4(new Blob([mp4File(samples, { ...LAYOUT, ...layout })]));
const ticks = (time: Float64Array) => [...time].map((seconds) => Math.round(seconds * TICKS * 1000) / 1000);

test('places, sizes and times of the images, and what the decoder needs', async () => {
  const { config, samples, turn, duration } = await of();
  const begin = FTYP.length + 8;
  assert.deepEqual([...samples.offset], [begin, begin + 100, begin + 150, begin + 170]);
  assert.deepEqual([...samples.size], [100, 50, 20, 30]);
  assert.deepEqual([...samples.key], [1, 0, 0, 0]);
  assert.deepEqual(ticks(samples.time), [1, 4, 2, 3]);
  assert.deepEqual(turn, { a: 1, b: 0, c: 0, d: 1 });
  assert.equal(Math.round(duration * TICKS), 5);
  assert.equal(config.codec, 'avc1.4d401e');
  assert.deepEqual(new Uint8Array(config.description as ArrayBuffer), AVC);
});

test('an edit list moves the first image to 0, and leaves out what lies outside', async () => {
  assert.deepEqual(ticks((await of({ edits: [{ duration: 4000 / TICKS, from: 1 }] })).samples.time), [0, 3, 1, 2]);
  assert.deepEqual(ticks((await of({ edits: [{ duration: 0, from: 2 }] })).samples.time), [NaN, 2, 0, 1]);
  assert.deepEqual(ticks((await of({ edits: [{ duration: 66, from: 2 }] })).samples.time), [NaN, NaN, 0, 1]);
  // Half a second of nothing, then the images.
  assert.deepEqual(ticks((await of({ edits: [{ duration: 500, from: -1 }, { duration: 200, from: 1 }] })).samples.time), [15, 18, 16, 17]);
});

test('an edit list that repeats images is left to the player', async () => {
  await assert.rejects(of({ edits: [{ duration: 100, from: 1 }, { duration: 100, from: 1 }] }), /edit list/);
});

test('the rotation of a phone held upright, and a mirror; other matrices are ignored', async () => {
  assert.deepEqual((await of({ matrix: [0, 1, -1, 0] })).turn, { a: 0, b: 1, c: -1, d: 0 });
  assert.deepEqual((await of({ matrix: [-1, 0, 0, 1] })).turn, { a: -1, b: 0, c: 0, d: 1 });
  assert.deepEqual((await of({ matrix: [0.5, 0, 0, 0.5] })).turn, { a: 1, b: 0, c: 0, d: 1 });
});

test('of a large file only the index is read', { skip: openAsBlob ? false : 'Node 18 cannot open files as Blobs' }, async () => {
  const folder = mkdtempSync(join(tmpdir(), 'alidade-mp4-'));
  try {
    const file = join(folder, 'large.mp4');
    const [gap, large] = [2 ** 28, 5 * 2 ** 28];
    const out = openSync(file, 'w');
    writeSync(out, FTYP);
    writeSync(out, longMdat(large));
    const moov = index(SAMPLES, LAYOUT, FTYP.length + 16, gap);
    writeSync(out, moov, 0, moov.length, FTYP.length + 16 + large); // the file has a hole before it
    closeSync(out);
    const blob = await openAsBlob!(file);
    let read = 0;
    const counted = { size: blob.size, slice: (from: number, to: number) => { const part = blob.slice(from, to); read += part.size; return part; } };
    const { samples } = await readMp4(counted as unknown as Blob);
    assert.equal(samples.offset[3], FTYP.length + 16 + 3 * gap + 170);
    assert.ok(read < 4096, `${read} bytes read`);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test('files that are no video, or end in their index, are refused', async () => {
  const whole = mp4File(SAMPLES, LAYOUT);
  await assert.rejects(readMp4(new Blob([whole.slice(0, -40)])));
  await assert.rejects(readMp4(new Blob([whole.slice(0, FTYP.length + 50)])), /no index/);
  await assert.rejects(readMp4(new Blob([new Uint8Array(100)])));
});
