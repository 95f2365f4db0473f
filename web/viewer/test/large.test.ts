// A large map: 2,000 keyframes, 500,000 points. Times are reported, not asserted.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { MapChange, Message } from '@alidade/scene';
import { encode } from '../../scene/test/encode.ts';
import { Random } from '../../scene/test/sample.ts';
import { launch, open, SKIP } from '../../shared/test/browser.ts';
import { startServer } from './server.ts';

const KEYFRAMES = 2000, LANDMARKS = 125, POINTS = 125; // landmarks and semi-dense points per keyframe

function large(): Message {
  const random = new Random(2);
  const keyframes: MapChange['keyframes'] = [];
  const landmarks = new DataView(new ArrayBuffer(20 * KEYFRAMES * LANDMARKS));
  const depth: MapChange['depth'] = [];
  for (let id = 0; id < KEYFRAMES; ++id) {
    const angle = (4 * Math.PI * id) / KEYFRAMES;
    const T_world_camera = [0, Math.sin(angle / 2), 0, Math.cos(angle / 2), 30 * Math.sin(angle), 0, 30 - 30 * Math.cos(angle)];
    const covisible = [...Array(10).keys()].map((k) => id - k - 1).filter((k) => k >= 0);
    keyframes.push({ id, map: 0, parent: id - 1 < 0 ? 0xffffffff : id - 1, number: 10 * id, time: id / 3, T_world_camera, scale: 1, covisible, loops: [] });
    for (let k = 0; k < LANDMARKS; ++k) {
      const at = 20 * (id * LANDMARKS + k);
      const z = 2 + 8 * random.next();
      landmarks.setUint32(at, id * LANDMARKS + k, true);
      landmarks.setUint32(at + 4, id, true);
      [z * (random.next() - 0.5), z * (random.next() - 0.5) * 0.75, z].forEach((value, c) => landmarks.setFloat32(at + 8 + 4 * c, value, true));
    }
    depth.push({ keyframe: id, least: 0.1, most: 1, points: Uint16Array.from({ length: 4 * POINTS }, () => 65536 * random.next()) });
  }
  const path = keyframes.map(({ id, time, number }) => (
    { number, time, state: 'tracking' as const, reference: id, T_reference_camera: [0, 0, 0, 1, 0, 0, 0] }));
  return {
    kind: 'map', version: 1n, whole: true, keyframes, moves: [], landmarks, removedLandmarks: new Uint32Array(0), culled: [], depth, path, worlds: null,
  };
}

test('a large map is shown, and can be turned', { skip: SKIP, timeout: 300e3 }, async (t) => {
  const server = await startServer({ speed: 0, sample: { frames: 10, landmarks: 10 } });
  const bytes = encode(large());
  const browser = await launch();
  t.after(() => Promise.all([browser.close(), server.close()]));
  const { page, problems } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  const shown = page.evaluate(async () => {
    const { alidade } = window as unknown as { alidade: { state: { keyframes: Map<number, unknown> } } };
    while (alidade.state.keyframes.size < 2000) await new Promise((resolve) => { setTimeout(resolve, 5); });
    const begin = performance.now();
    await new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); });
    return performance.now() - begin;
  });
  const sent = performance.now();
  server.send(bytes);
  const drawing = await shown;
  t.diagnostic(`${(bytes.length / 1e6).toFixed(1)} MB; ${Math.round(performance.now() - sent)} ms from sending to the picture, ${Math.round(drawing)} of it drawing`);
  await page.keyboard.press('2');
  await page.keyboard.press('f');
  await page.waitForTimeout(2000);
  const pictures = page.evaluate(async () => {
    let count = 0;
    const begin = performance.now();
    while (performance.now() - begin < 5000) {
      await new Promise((resolve) => { requestAnimationFrame(resolve); });
      ++count;
    }
    return count / 5;
  });
  await page.mouse.move(600, 650);
  await page.mouse.down();
  for (let i = 0, end = Date.now() + 5000; Date.now() < end; ++i) {
    await page.mouse.move(600 + i, 650);
    await page.waitForTimeout(30);
  }
  await page.mouse.up();
  t.diagnostic(`${(await pictures).toFixed(1)} pictures a second while turning`);
  // Time per image with one layer and all its points.
  for (const layer of ['landmarks', 'cloud', 'keyframes', 'path', 'covisibility', 'none']) {
    const ms = await page.evaluate(async (only) => {
      const { alidade } = window as unknown as { alidade: { scene: { show(name: string, on: boolean): void; layers: object; measure(): number } } };
      for (const name of Object.keys(alidade.scene.layers)) alidade.scene.show(name, name === only);
      return alidade.scene.measure();
    }, layer);
    t.diagnostic(`${layer}: ${Math.round(ms)} ms`);
  }
  assert.deepEqual(problems, []);
});
