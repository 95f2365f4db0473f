// A fake motion sensor for tests, in the page: dispatches the readings of a recording beside the fake camera that plays
// its images, and stamps both as a device does that knows when an image was taken. (The fake camera's own stamps are when
// its timer fired, which on a busy machine is tens of milliseconds late.)
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { BITS, CELL } from '../../shared/test/y4m.ts';

export interface FakeMotion {
  readings: number[][]; // motion.csv: seconds, acceleration with gravity x y z, turning about x y z in deg/s
  times: number[]; // of the images, seconds
  sign: 1 | -1; // -1: as Safari
  orientation: boolean; // deviceorientation events are sent, too
}

export const BEGIN = 10; // seconds of the images' clock at the first image

export function motionOf(folder: string, times: number[]): FakeMotion {
  const lines = readFileSync(join(folder, 'motion.csv'), 'utf8').split('\n').filter((line) => line && !line.startsWith('#'));
  return { readings: lines.map((line) => line.split(',').map(Number)), times, sign: 1, orientation: false };
}

export async function install(page: Page, motion: FakeMotion): Promise<void> {
  await page.addInitScript(({ readings, times, sign, orientation, cell, bits, begin }) => {
    const canvas = new OffscreenCanvas(cell * bits, cell);
    const draw = canvas.getContext('2d', { willReadFrequently: true })!;
    // Number of the image, from the squares in its corner.
    const numberOf = (video: HTMLVideoElement) => {
      draw.drawImage(video, 0, 0);
      const { data } = draw.getImageData(0, 0, canvas.width, cell);
      let number = 0;
      for (let bit = 0; bit < bits; ++bit) if (data[4 * ((cell / 2) * canvas.width + bit * cell + cell / 2)]! > 128) number |= 1 << bit;
      return number;
    };
    let base: number | null = null; // page's clock at second 0 of the recording
    let last = -1;
    let next = 0;
    const send = (until: number) => {
      for (; next < readings.length && readings[next]![0]! <= until; ++next) {
        const [t, ax, ay, az, x, y, z] = readings[next]! as [number, number, number, number, number, number, number];
        const stamp = { value: 1000 * (base! + t) };
        const length = Math.hypot(ax, ay, az);
        // Good enough for which way is up: the accelerations of a hand are small.
        const turned = new DeviceOrientationEvent('deviceorientation', { alpha: 0, beta: (Math.asin(ay / length) * 180) / Math.PI, gamma: (Math.atan2(-ax, az) * 180) / Math.PI });
        if (orientation) window.dispatchEvent(turned);
        const moved = new DeviceMotionEvent('devicemotion', { accelerationIncludingGravity: { x: sign * ax, y: sign * ay, z: sign * az }, rotationRate: { beta: x, gamma: y, alpha: z }, interval: 16 });
        window.dispatchEvent(Object.defineProperty(moved, 'timeStamp', stamp));
      }
    };
    const original = HTMLVideoElement.prototype.requestVideoFrameCallback;
    HTMLVideoElement.prototype.requestVideoFrameCallback = function request(callback) {
      return original.call(this, (now, metadata) => {
        const number = numberOf(this);
        if (number < last || number >= times.length) { // the recording begins again
          document.body.dataset.played = 'yes';
          return;
        }
        last = number;
        const time = times[number]!;
        base ??= now / 1000 - time - 0.03;
        send(time + 0.05);
        callback(now, { ...metadata, mediaTime: begin + time, captureTime: 1000 * (base + time) });
      });
    };
  }, { ...motion, cell: CELL, bits: BITS, begin: BEGIN });
}
