// Minutes of the fake camera, forwards and backwards: memory is bounded and the rate constant. Enabled by
// ALIDADE_MINUTES=10.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { launch, open, SKIP } from '../../shared/test/browser.ts';
import { startSite } from './server.ts';
import { openRecording, writeY4m } from '../../shared/test/y4m.ts';

declare const WEB: string;

const minutes = Number(process.env.ALIDADE_MINUTES ?? 0);
const kitchen = join(process.env.ALIDADE_DATA ?? '', 'kitchen');
const lacks = SKIP || !(minutes > 0) && 'ALIDADE_MINUTES does not ask for it' || !existsSync(join(WEB, 'core/dist/single/alidade.wasm')) && 'scripts/wasm/build has not been run'
  || !(process.env.ALIDADE_DATA && existsSync(kitchen)) && 'ALIDADE_DATA does not point to the recordings' || false;
const MOST = 800; // MB: the page, its Worker and the core's memory, with at most 2000 keyframes

test('minutes of camera: memory and rate hold', { skip: lacks, timeout: (minutes + 5) * 60e3 }, async () => {
  const folder = mkdtempSync(join(tmpdir(), 'alidade-long-'));
  const recording = openRecording(kitchen);
  const there = Array.from({ length: 300 }, (_, i) => i);
  writeY4m(join(folder, 'camera.y4m'), recording, [...there, ...there.slice(1, -1).reverse()]);
  const browser = await launch(['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${join(folder, 'camera.y4m')}`]);
  const site = await startSite(true);
  const { page, problems } = await open(browser, site.address, { viewport: { width: 412, height: 915 }, isMobile: true, hasTouch: true, permissions: ['camera'] });
  await page.tap('#start');
  const told: { megabytes: number; rate: number }[] = [];
  const begin = Date.now();
  let [frames, at] = [0, begin];
  while (Date.now() - begin < minutes * 60e3) {
    await page.waitForTimeout(20e3);
    // Chromium answers at the next garbage collection.
    const bytes = await page.evaluate(async () => (await (performance as unknown as { measureUserAgentSpecificMemory(): Promise<{ bytes: number }> }).measureUserAgentSpecificMemory()).bytes);
    const now = await page.evaluate(() => ({ frames: window.phone.counters.processed, keyframes: window.phone.state.keyframes.size, points: window.phone.state.landmarks.size }));
    const rate = (1000 * (now.frames - frames)) / (Date.now() - at);
    [frames, at] = [now.frames, Date.now()];
    told.push({ megabytes: bytes / 1e6, rate });
    console.log(`${((at - begin) / 60e3).toFixed(1)} min: ${(bytes / 1e6).toFixed(0)} MB, ${rate.toFixed(1)} pictures/s, ${now.keyframes} keyframes, ${now.points} points, ${await page.getAttribute('body', 'data-state')}`);
  }
  assert.ok(told.every(({ megabytes }) => megabytes < MOST));
  const half = told.length >> 1;
  const mean = (part: typeof told) => part.reduce((sum, { rate }) => sum + rate, 0) / part.length;
  assert.ok(mean(told.slice(half)) > 0.7 * mean(told.slice(0, half)), 'it has become slower');
  assert.deepEqual(problems, []);
  await browser.close();
  await site.close();
  rmSync(folder, { recursive: true });
});
