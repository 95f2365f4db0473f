// Writes a file for Chromium's fake camera: frames of a recording as raw video, each with its number encoded in the
// upper left corner.
import { closeSync, openSync, readFileSync, writeSync } from 'node:fs';
import { join } from 'node:path';
import jpeg from 'jpeg-js';
import { readPng } from '../../scene/test/png.ts';

export const CELL = 16; // pixels per bit of the number
export const BITS = 12;

export interface Recording { times: number[]; files: string[]; width: number; height: number }

export interface Pixels { width: number; height: number; data: Uint8Array } // red green blue alpha

export function readPicture(file: string): Pixels {
  const bytes = readFileSync(file);
  if (!file.endsWith('.png')) return jpeg.decode(bytes, { useTArray: true });
  const { width, height, channels, samples } = readPng(bytes);
  const of = (i: number, channel: number) => (channels === 1 ? samples[i]! : channel === 3 ? 255 : samples[channels * i + channel]!);
  return { width, height, data: Uint8Array.from({ length: 4 * width * height }, (_, k) => of(k >> 2, k & 3)) };
}

export function openRecording(folder: string): Recording {
  const lines = readFileSync(join(folder, 'rgb.txt'), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(/\s+/));
  const files = lines.map(([, name]) => join(folder, name!));
  const { width, height } = readPicture(files[0]!);
  return { times: lines.map(([time]) => Number(time)), files, width, height };
}

// A frame of the recording in gray, one byte per pixel.
export function grayOf({ files }: Recording, number: number): Uint8Array {
  const { width, height, data } = readPicture(files[number]!);
  return Uint8Array.from({ length: width * height }, (_, k) => (299 * data[4 * k]! + 587 * data[4 * k + 1]! + 114 * data[4 * k + 2]! + 500) / 1000);
}

export const DARK = -1; // a black frame

// `order`: frames of the recording, or DARK, in playback order, `rate` per second.
export function writeY4m(path: string, { files, width, height }: Recording, order: readonly number[], numbered = true, rate = 30): void {
  const out = openSync(path, 'w');
  writeSync(out, `YUV4MPEG2 W${width} H${height} F${rate}:1 Ip A1:1 C420jpeg\n`);
  const y = Buffer.alloc(width * height);
  const u = Buffer.alloc((width * height) / 4);
  const v = Buffer.alloc((width * height) / 4);
  for (const number of order) {
    const { data } = number === DARK ? { data: new Uint8Array(4 * width * height) } : readPicture(files[number]!);
    // BT.601, limited range, as browsers expect.
    for (let i = 0; i < width * height; ++i) y[i] = 16 + (65.738 * data[4 * i]! + 129.057 * data[4 * i + 1]! + 25.064 * data[4 * i + 2]!) / 256;
    for (let r = 0; r < height / 2; ++r) {
      for (let c = 0; c < width / 2; ++c) {
        const i = 4 * (2 * r * width + 2 * c);
        u[(r * width) / 2 + c] = 128 + (-37.945 * data[i]! - 74.494 * data[i + 1]! + 112.439 * data[i + 2]!) / 256;
        v[(r * width) / 2 + c] = 128 + (112.439 * data[i]! - 94.154 * data[i + 1]! - 18.285 * data[i + 2]!) / 256;
      }
    }
    for (let bit = 0; numbered && bit < BITS; ++bit) {
      for (let r = 0; r < CELL; ++r) y.fill((number >> bit) & 1 ? 235 : 16, r * width + bit * CELL, r * width + (bit + 1) * CELL);
    }
    writeSync(out, 'FRAME\n');
    for (const plane of [y, u, v]) writeSync(out, plane);
  }
  closeSync(out);
}
