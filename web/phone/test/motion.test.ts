// The motion sensor in Node: units, clocks, signs, and devices without one. `window` is an event target.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Motion } from '../src/motion.ts';

const scope = globalThis as unknown as Record<string, unknown>;
let answer = 'granted';
before(() => {
  scope.window = new EventTarget();
  scope.DeviceMotionEvent = class { static requestPermission = async () => answer; }; // as on iOS
  scope.DeviceOrientationEvent = class {};
});
after(() => { for (const name of ['window', 'DeviceMotionEvent', 'DeviceOrientationEvent']) delete scope[name]; });

const send = (name: string, values: object) => {
  const event = new Event(name);
  for (const [key, value] of Object.entries(values)) Object.defineProperty(event, key, { value });
  window.dispatchEvent(event);
};
const motion = (milliseconds: number, sign = 1) => send('devicemotion', {
  timeStamp: milliseconds, accelerationIncludingGravity: { x: sign * 0.5, y: sign * 9.7, z: sign * 1.5 }, rotationRate: { alpha: 30, beta: 10, gamma: 20 },
});
const images = (sensor: Motion, count: number, time = 4, at = 104) => { for (let i = 0; i < count; ++i) sensor.image(time + i / 30, at + i / 30 + (i % 3) / 100); };
const near = (values: ArrayLike<number>, expected: readonly number[]) => {
  assert.equal(values.length, expected.length);
  expected.forEach((value, i) => assert.ok(Math.abs(values[i]! - value) < 1e-9, `${i}: ${values[i]} against ${value}`));
};
const DEGREE = Math.PI / 180;

test('readings are in rad/s about x y z, and on the clock of the images', async () => {
  const sensor = await Motion.open('Google Inc.');
  assert.equal(sensor.state, 'waiting');
  motion(103900);
  assert.equal(sensor.state, 'on');
  assert.equal(sensor.take().length, 0); // until the clocks are known
  images(sensor, 10);
  near(sensor.take(), [3.9, 10 * DEGREE, 20 * DEGREE, 30 * DEGREE, 0.5, 9.7, 1.5]);
  assert.equal(sensor.take().length, 0);
  images(sensor, 10, 0, 110); // the camera was opened again
  motion(110500);
  assert.ok(Math.abs(sensor.take()[0]! - 0.5) < 1e-9);
  sensor.close();
  motion(110600);
  assert.equal(sensor.take().length, 0);
});

for (const [what, vendor, sign, upright] of [
  ['of the specification', 'Google Inc.', 1, false], ['of Safari, by its engine', 'Apple Computer, Inc.', -1, false],
  ['of the specification in an engine of Apple, by the orientation', 'Apple Computer, Inc.', 1, true], ['of Safari in another engine, by the orientation', 'Google Inc.', -1, true],
] as const) {
  test(`the sign ${what}: at rest the force points up`, async () => {
    const sensor = await Motion.open(vendor);
    if (upright) send('deviceorientation', { alpha: 12, beta: 80, gamma: 5 }); // held upright
    for (let i = 0; i < 5; ++i) motion(104000 + 16 * i, sign);
    images(sensor, 10);
    near(sensor.take().slice(4, 7), [0.5, 9.7, 1.5]);
    sensor.close();
  });
}

test('a device without a sensor, and a user who refuses', async () => {
  const sensor = await Motion.open('Google Inc.');
  send('devicemotion', { timeStamp: 0, accelerationIncludingGravity: null, rotationRate: null }); // as on a computer
  images(sensor, 120);
  assert.equal(sensor.state, 'none');
  sensor.close();
  answer = 'denied';
  const refused = await Motion.open('Apple Computer, Inc.');
  assert.equal(refused.state, 'refused');
  images(refused, 20);
  assert.equal(refused.take().length, 0);
});
