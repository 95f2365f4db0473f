// A video that is made for the test goes through the page image by image: each once, in order, upright. Needs no recording.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { launch, open, SKIP } from '../../shared/test/browser.ts';
import { mp4File, TICKS } from './mp4_file.ts';
import type { Layout } from './mp4_file.ts';
import { startSite } from './server.ts';
import type { Site } from './server.ts';

declare const WEB: string;

const options = { skip: SKIP || (existsSync(join(WEB, 'core/dist/single/alidade.wasm')) ? false : 'scripts/wasm/build has not been run'), timeout: 240e3 };
const FRAMES = 40;
const [WIDTH, HEIGHT] = [320, 240];
const BAR = 8; // bits of the frame's number, as bright and dark fields along the upper edge of the upright image
const VP9: Layout = { width: WIDTH, height: HEIGHT, entry: 'vp09', configuration: Uint8Array.of(1, 0, 0, 0, 0, 10, 0x82, 2, 2, 2, 0, 0) };
const ALL = Array.from({ length: FRAMES }, (_, i) => i);

let browser: Browser;
let site: Site;

before(async () => {
  if (options.skip) return;
  browser = await launch();
  site = await startSite(false);
});
after(async () => {
  await browser?.close();
  await site?.close();
});

// VP9 images encoded by the browser. `turned`: lying on the side, as a phone held upright stores them.
async function encode(page: Page, turned: boolean): Promise<{ data: Uint8Array; key: boolean }[]> {
  const told = await page.evaluate(async ([frames, width, height, bar, lying]) => {
    const made: { data: number[]; key: boolean }[] = [];
    const encoder = new VideoEncoder({
      output: (chunk) => {
        const data = new Uint8Array(chunk.byteLength);
        chunk.copyTo(data);
        made.push({ data: [...data], key: chunk.type === 'key' });
      },
      error: (error) => { throw error; },
    });
    encoder.configure({ codec: 'vp09.00.10.08', width, height, bitrate: 2e6 });
    const canvas = new OffscreenCanvas(width, height);
    const draw = canvas.getContext('2d')!;
    for (let i = 0; i < frames; ++i) {
      draw.setTransform(1, 0, 0, 1, 0, 0);
      draw.fillStyle = '#777';
      draw.fillRect(0, 0, width, height);
      if (lying) draw.setTransform(0, -1, 1, 0, 0, height); // undone by a quarter turn clockwise
      for (let bit = 0; bit < bar; ++bit) {
        draw.fillStyle = (i >> bit) & 1 ? '#fff' : '#000';
        draw.fillRect(bit * 20, 0, 20, 20);
      }
      const frame = new VideoFrame(canvas, { timestamp: (i * 1e6) / 30 });
      encoder.encode(frame, { keyFrame: i % 15 === 0 });
      frame.close();
    }
    await encoder.flush();
    encoder.close();
    return made;
  }, [FRAMES, WIDTH, HEIGHT, BAR, turned] as const);
  return told.map(({ data, key }) => ({ data: Uint8Array.from(data), key }));
}

// Numbers, times and size of the images that the page processed.
async function work(page: Page, video: Uint8Array): Promise<{ numbers: number[]; times: number[]; size: number[] }> {
  await page.waitForSelector('#file:enabled', { state: 'attached' });
  await page.evaluate((bar) => {
    const seen = { numbers: [] as number[], times: [] as number[], size: [] as number[] };
    Object.assign(window, { shown: seen });
    window.phone.watch(({ bitmap, time }) => {
      const { width, height } = bitmap!;
      const draw = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!;
      draw.drawImage(bitmap!, 0, 0);
      let number = 0;
      for (let bit = 0; bit < bar; ++bit) if (draw.getImageData(20 * bit + 10, 10, 1, 1).data[0]! > 128) number |= 1 << bit;
      seen.numbers.push(number);
      seen.times.push(time);
      seen.size = [width, height];
    });
  }, BAR);
  await page.setInputFiles('#file', { name: 'made.mp4', mimeType: 'video/mp4', buffer: Buffer.from(video) });
  await page.waitForFunction(() => document.body.dataset.phase === 'ended' || !document.getElementById('notice')!.hidden, undefined, { timeout: 120e3 });
  assert.equal(await page.textContent('#notice'), '');
  return page.evaluate(() => (window as unknown as { shown: { numbers: number[]; times: number[]; size: number[] } }).shown);
}

const ticks = (times: readonly number[]) => times.map((time) => Math.round(time * TICKS * 100) / 100);

test('each image once, in order; the script for it is loaded when it is needed', options, async () => {
  const { page, problems, requests } = await open(browser, site.address);
  const video = mp4File(await encode(page, false), VP9);
  const loaded = () => requests.some((address) => address.endsWith('/mp4.js'));
  assert.equal(loaded(), false);
  const { numbers, times, size } = await work(page, video);
  assert.ok(loaded());
  assert.deepEqual(numbers, ALL);
  assert.deepEqual(ticks(times), ALL);
  assert.deepEqual(size, [WIDTH, HEIGHT]);
  assert.equal(await page.textContent('[data-count=frames]'), String(FRAMES));
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('a phone held upright, and a video cut at its begin', options, async () => {
  const { page, problems } = await open(browser, site.address);
  const cut = 20;
  const video = mp4File(await encode(page, true), { ...VP9, matrix: [0, 1, -1, 0], edits: [{ duration: 0, from: cut }] });
  const { numbers, times, size } = await work(page, video);
  assert.deepEqual(numbers, ALL.slice(cut));
  assert.deepEqual(ticks(times), ALL.slice(0, -cut));
  assert.deepEqual(size, [HEIGHT, WIDTH]);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('a damaged video: the images before the damage, and what happened', options, async () => {
  const { page, problems } = await open(browser, site.address);
  const samples = await encode(page, false);
  samples[30]!.data = samples[30]!.data.map(() => 255); // damaged; it is a key frame
  const made = mp4File(samples, VP9);
  await page.waitForSelector('#file:enabled', { state: 'attached' });
  await page.setInputFiles('#file', { name: 'made.mp4', mimeType: 'video/mp4', buffer: Buffer.from(made) });
  await page.waitForFunction(() => document.body.dataset.phase === 'ended');
  assert.match((await page.textContent('#notice'))!, /made\.mp4 could not be read to its end/);
  assert.ok(await page.evaluate(() => window.phone.counters.processed) >= 25);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('a browser without decoders for pages plays the video instead', options, async () => {
  const { page } = await open(browser, site.address);
  const video = mp4File(await encode(page, false), VP9);
  await page.evaluate(() => { delete (window as { VideoDecoder?: unknown }).VideoDecoder; });
  const { numbers, times } = await work(page, video);
  // A busy machine misses some.
  assert.ok(numbers.length > FRAMES / 4, `${numbers.length} images`);
  assert.deepEqual(ticks(times), numbers);
  await page.context().close();
});
