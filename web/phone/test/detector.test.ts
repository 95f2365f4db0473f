// Excluding people in the page: a detector's file is added, its network runs beside the camera, and tracking does not
// wait for it.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { USES } from '../../scene/src/messages.ts';
import type { Browser, Page } from 'playwright-core';
import { launch, open, SKIP, violations } from '../../shared/test/browser.ts';
import { readPng } from '../../scene/test/png.ts';
import { DETECTOR, startSite } from './server.ts';
import type { Site } from './server.ts';
import { BITS, CELL, openRecording, writeY4m } from '../../shared/test/y4m.ts';

declare const WEB: string;

const data = process.env.ALIDADE_DATA ?? '';
const walk = join(data, 'kitchen_walk');
const model = join(data, '../models/yolov5n_640x480.onnx');
const lacks = SKIP || (!existsSync(join(WEB, 'core/dist/single/alidade.wasm')) && 'scripts/wasm/build has not been run')
  || (!existsSync(join(DETECTOR, 'ort.wasm.min.mjs')) && 'scripts/wasm/build detector has not been run') || false;
const options = { skip: lacks, timeout: 300e3 };
const onWalk = { ...options, skip: lacks || (!(data && existsSync(walk) && existsSync(model)) && 'ALIDADE_DATA, and the folder models beside it, are needed') || false };
const PHONE = { viewport: { width: 412, height: 915 }, isMobile: true, hasTouch: true, permissions: ['camera'] };
const FRAMES = 240;
// Images per second for a recording at 30 Hz, so that people walk at a third of their speed and late detections still
// overlap them. The delay depends on the machine's load; this test is about the exclusion, not about speed.
const RATE = 10;

let folder = '';
let browser: Browser;
let site: Site;

before(async () => {
  if (lacks) return;
  folder = mkdtempSync(join(tmpdir(), 'alidade-detector-'));
  const camera = join(folder, 'camera.y4m');
  if (!onWalk.skip) {
    const there = Array.from({ length: FRAMES }, (_, i) => i);
    writeY4m(camera, openRecording(walk), [...there, ...there.slice(1, -1).reverse()], true, RATE);
  }
  browser = await launch(['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', ...(onWalk.skip ? [] : [`--use-file-for-fake-video-capture=${camera}`])]);
  site = await startSite(true);
});
after(async () => {
  await browser?.close();
  await site?.close();
  if (folder) rmSync(folder, { recursive: true });
});

// Number of the recording's frame; x, y (shares of the image) and use of each feature.
interface Seen { number: number; features: number[] }

const noting = (page: Page) => page.evaluate(([cell, bits]) => {
  const all: Seen[] = [];
  Object.assign(window, { noted: all });
  const draw = new OffscreenCanvas(cell! * bits!, cell!).getContext('2d', { willReadFrequently: true })!;
  window.phone.watch(({ bitmap }) => {
    draw.drawImage(bitmap!, 0, 0);
    const { data: pixels } = draw.getImageData(0, 0, cell! * bits!, cell!);
    let number = 0;
    for (let bit = 0; bit < bits!; ++bit) if (pixels[4 * ((cell! / 2) * cell! * bits! + bit * cell! + cell! / 2)]! > 128) number |= 1 << bit;
    const packed = window.phone.state.frame?.features;
    if (!packed) return; // a new map was begun and no frame was sent yet
    const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
    const features: number[] = [];
    for (let at = 0; at + 6 <= packed.length; at += 6) features.push(view.getUint16(at, true) / 65536, view.getUint16(at + 2, true) / 65536, packed[at + 4]!);
    all.push({ number, features });
  });
}, [CELL, BITS]);

// Number of features per image on the people's true masks, used and excluded.
function onPeople(seen: readonly Seen[]): { used: number; leftOut: number; elsewhere: number } {
  const names = readFileSync(join(walk, 'mask.txt'), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(/\s+/)[1]!);
  const masks = new Map<number, ReturnType<typeof readPng>>();
  const sums = { used: 0, leftOut: 0, elsewhere: 0 };
  for (const { number, features } of seen) {
    if (!masks.has(number)) masks.set(number, readPng(readFileSync(join(walk, names[number]!))));
    const { width, height, channels, samples } = masks.get(number)!;
    for (let i = 0; i < features.length; i += 3) {
      const person = samples[channels * (Math.floor(features[i + 1]! * height) * width + Math.floor(features[i]! * width))]! > 0;
      const moving = USES[features[i + 2]!] === 'moving';
      if (person) ++sums[moving ? 'leftOut' : 'used'];
      else if (moving) ++sums.elsewhere;
    }
  }
  return { used: sums.used / seen.length, leftOut: sums.leftOut / seen.length, elsewhere: sums.elsewhere / seen.length };
}

const add = async (page: Page, file: string) => {
  await page.tap('#settings-open');
  await page.setInputFiles('#set-detector', file);
  await page.waitForFunction(() => !/Trying|none/.test(document.getElementById('detector-note')!.textContent!), undefined, { timeout: 60e3 });
  const note = (await page.textContent('#detector-note'))!;
  await page.locator('#settings form button').click();
  return note;
};
const noted = (page: Page, more: number) => page.evaluate(() => (window as unknown as { noted: Seen[] }).noted.length).then((now) =>
  page.waitForFunction((n) => (window as unknown as { noted: Seen[] }).noted.length >= n, now + more, { timeout: 120e3 }));

test('what is no detector is not taken, and said', options, async () => {
  const { page, problems } = await open(browser, site.address, PHONE);
  const text = join(folder, 'letter.onnx');
  writeFileSync(text, 'Dear Sir or Madam,\n');
  assert.match(await add(page, text), /letter\.onnx was not taken: .*ONNX/);
  assert.equal(await page.isVisible('#remove-detector'), false);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('people are left out, and the camera does not wait for the network', onWalk, async () => {
  const { page, problems, requests } = await open(browser, site.address, PHONE);
  // Without a detector everything is used, and no detector file is fetched.
  await page.tap('#start');
  await page.waitForFunction(() => document.body.dataset.state === 'tracking', undefined, { timeout: 60e3 });
  await noting(page);
  await noted(page, 200);
  const without = onPeople(await page.evaluate(() => (window as unknown as { noted: Seen[] }).noted));
  const rate = async () => page.evaluate(() => window.phone.counters.processed).then(async (before) => {
    const begin = Date.now();
    await page.waitForTimeout(5000);
    return (1000 * (await page.evaluate(() => window.phone.counters.processed) - before)) / (Date.now() - begin);
  });
  const rateWithout = await rate();
  assert.deepEqual(requests.filter((url) => url.includes('core/detector/')), []);
  await page.tap('#stop');
  await page.tap('#again');

  assert.match(await add(page, model), /yolov5n_640x480\.onnx: 80 kinds of things, people among them/);
  assert.deepEqual((await violations(page)).filter((text) => /^(serious|critical)/.test(text)), []);
  await page.tap('#start');
  await page.waitForFunction(() => document.body.dataset.state === 'tracking' && window.phone.detector.looks > 3, undefined, { timeout: 90e3 });
  await noting(page);
  const [looks, processed] = await page.evaluate(() => [window.phone.detector.looks, window.phone.counters.processed] as const);
  await noted(page, 200);
  const later = await page.evaluate(() => [window.phone.detector.looks, window.phone.counters.processed] as const);
  const found = onPeople(await page.evaluate(() => (window as unknown as { noted: Seen[] }).noted));
  const age = await page.evaluate(() => window.phone.state.frame!.detectionAge);
  const rateWith = await rate();
  const milliseconds = await page.evaluate(() => window.phone.detector.milliseconds);
  console.log(`features on people a picture: ${without.used.toFixed(1)} used without a detector; with it ${found.used.toFixed(1)} used, ${found.leftOut.toFixed(1)} left out, ${found.elsewhere.toFixed(1)} elsewhere; `
    + `${rateWithout.toFixed(1)} pictures/s without, ${rateWith.toFixed(1)} with; ${milliseconds.toFixed(0)} ms a look, ${((later[1] - processed) / (later[0] - looks)).toFixed(1)} pictures for each, ${age.toFixed(2)} s late`);
  assert.ok(without.used > 5 && without.leftOut === 0);
  assert.ok(found.used < 0.7 * without.used, // lenient, because detections are late
     `${found.used} of ${without.used}`);
  assert.ok(later[1] - processed > 2 * (later[0] - looks), 'pictures wait for the network');
  assert.ok(age > 0);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('a detector that was added is there offline, and can be removed', onWalk, async () => {
  const own = await startSite(true);
  const { page } = await open(browser, own.address, PHONE);
  await page.waitForFunction(() => document.body.dataset.offline === 'ready');
  await page.reload(); // through the service worker, so that all files are cached
  await add(page, model);
  await page.tap('#start');
  await page.waitForFunction(() => window.phone.detector.looks > 0, undefined, { timeout: 60e3 });
  await own.close();
  await page.reload();
  await page.tap('#start');
  await page.waitForFunction(() => window.phone.detector.looks > 0, undefined, { timeout: 60e3 });
  await page.tap('#stop');
  await page.tap('#settings-open');
  await page.tap('#remove-detector');
  assert.equal(await page.textContent('#detector-note'), 'none');
  assert.equal(await page.evaluate(async () => (await caches.keys()).includes('detector')), false);
  await page.context().close();
});
