// Tests the phone page in a real browser with a fake camera that plays a real recording.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { devices } from 'playwright-core';
import type { Browser, Page } from 'playwright-core';
import { CHROMIUM, differing, launch, open, screenshot, SKIP, violations } from '../../shared/test/browser.ts';
import type { Done, FromWorker } from '../src/protocol.ts';
import { startSite } from './server.ts';
import type { Site } from './server.ts';
import { BITS, CELL, openRecording, writeY4m } from '../../shared/test/y4m.ts';
import type { Recording } from '../../shared/test/y4m.ts';

declare const WEB: string;

const program = process.env.ALIDADE_BINARY ?? join(WEB, '../build/bin/alidade');
const kitchen = join(process.env.ALIDADE_DATA ?? '', 'kitchen');
const lacks = SKIP || (!existsSync(join(WEB, 'core/dist/single/alidade.wasm')) && 'scripts/wasm/build has not been run')
  || (!(process.env.ALIDADE_DATA && existsSync(kitchen) && existsSync(program)) && 'ALIDADE_DATA does not point to the recordings') || false;
const options = { skip: lacks, timeout: 240e3 };
const PHONE = { viewport: { width: 412, height: 915 }, isMobile: true, hasTouch: true, deviceScaleFactor: 2, userAgent: devices['Pixel 7'].userAgent };
const FRAMES = 300;

interface Phone {
  counters: { processed: number; milliseconds: number[] };
  engine: { ask(what: string): Promise<Uint8Array> } | null;
  state: { keyframes: Map<number, unknown>; landmarks: { size: number }; frame: { features: Uint8Array; detectionAge: number } | null };
  detector: { looks: number; things: number; milliseconds: number };
  cube: unknown;
  watch(hook: (done: Done) => void): void;
}
declare global { interface Window { phone: Phone; seen: { time: number; number: number }[]; placed?: { offered: boolean; removed: boolean } } }

let folder = '';
let recording: Recording;
let browser: Browser;
let refusing: Browser;
let sites: { isolated: Site; plain: Site };

before(async () => {
  if (lacks) return;
  folder = mkdtempSync(join(tmpdir(), 'alidade-phone-'));
  recording = openRecording(kitchen);
  const there = Array.from({ length: FRAMES }, (_, i) => i);
  writeY4m(join(folder, 'camera.y4m'), recording, [...there, ...there.slice(1, -1).reverse()]);
  const camera = ['--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${join(folder, 'camera.y4m')}`];
  browser = await launch(['--use-fake-ui-for-media-stream', ...camera]);
  refusing = await launch(['--deny-permission-prompts', ...camera]);
  sites = { isolated: await startSite(true), plain: await startSite(false) };
});
after(async () => {
  await browser?.close();
  await refusing?.close();
  await sites?.isolated.close();
  await sites?.plain.close();
  if (folder) rmSync(folder, { recursive: true });
});

const processed = (page: Page, least: number) =>
  page.waitForFunction((n) => Number(document.body.dataset.frames ?? 0) >= n, least, { timeout: 120e3 });

// Records which frame of the recording each image was.
const noting = (page: Page) => page.evaluate(([cell, bits]) => {
  window.seen = [];
  const canvas = new OffscreenCanvas(cell! * bits!, cell!);
  const draw = canvas.getContext('2d', { willReadFrequently: true })!;
  window.phone.watch(({ bitmap, time }) => {
    draw.drawImage(bitmap!, 0, 0);
    const { data } = draw.getImageData(0, 0, canvas.width, cell!);
    let number = 0;
    for (let bit = 0; bit < bits!; ++bit) if (data[4 * ((cell! / 2) * canvas.width + bit * cell! + cell! / 2)]! > 128) number |= 1 << bit;
    window.seen.push({ time, number });
  });
}, [CELL, BITS]);

// ATE in meters of the page's trajectory against the ground truth of the frames it processed.
async function error(page: Page): Promise<{ rmse: number; tracked: number; frames: number }> {
  const text = await page.evaluate(async () => new TextDecoder().decode(await window.phone.engine!.ask('trajectory')));
  const seen = await page.evaluate(() => window.seen);
  const truth = readFileSync(join(kitchen, 'groundtruth.txt'), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(' '));
  const near = (time: number) => truth.reduce((best, line) => (Math.abs(Number(line[0]) - time) < Math.abs(Number(best[0]) - time) ? line : best));
  const of = new Map(seen.map(({ time, number }) => [time.toFixed(4), near(recording.times[number]!)]));
  const lines = text.split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(' '));
  const paired = lines.filter(([time]) => of.has(Number(time).toFixed(4)));
  assert.ok(paired.length > 0.95 * lines.length && paired.length > 10, `${paired.length} of ${lines.length} poses are of noted pictures`);
  writeFileSync(join(folder, 'here.txt'), paired.map((line) => line.join(' ')).join('\n') + '\n');
  writeFileSync(join(folder, 'truth.txt'), paired.map((line) => [line[0], ...of.get(Number(line[0]).toFixed(4))!.slice(1)].join(' ')).join('\n') + '\n');
  const { rmse } = JSON.parse(execFileSync(program, ['evaluate', 'ate', join(folder, 'truth.txt'), join(folder, 'here.txt'), '--align', 'sim3', '--json'], { encoding: 'utf8' })) as { rmse: number };
  return { rmse, tracked: paired.length, frames: seen.length };
}

for (const kind of ['isolated', 'plain'] as const) {
  test(`camera, map, truth, tab away and back: ${kind} (${CHROMIUM})`, options, async () => {
    const { page, problems } = await open(browser, sites[kind].address, { ...PHONE, permissions: ['camera'] });
    assert.equal(await page.evaluate(() => self.crossOriginIsolated), kind === 'isolated');
    assert.deepEqual((await violations(page)).filter((text) => /^(serious|critical)/.test(text)), []);
    await noting(page);
    const begin = Date.now();
    await page.tap('#start');
    await processed(page, 60);
    const first = await page.evaluate(() => window.phone.counters.processed);
    const count = async (name: string) => Number(await page.textContent(`[data-count=${name}]`));
    await processed(page, first + 150);
    const seconds = await page.evaluate(() => (window.seen.at(-1)!.time - window.seen.at(-101)!.time));
    const dark = await screenshot(page);
    assert.ok(await count('keyframes') > 3 && await count('landmarks') > 200 && await count('matches') > 30, `${await count('keyframes')} keyframes, ${await count('landmarks')} points`);
    assert.deepEqual((await violations(page)).filter((text) => /^(serious|critical)/.test(text)), []);
    await processed(page, first + 250);
    assert.ok(differing(await screenshot(page), dark) > 1000, 'the page stands still');
    const { rmse, tracked, frames } = await error(page);
    const ms = await page.evaluate(() => [...window.phone.counters.milliseconds].sort((a, b) => a - b)[window.phone.counters.milliseconds.length >> 1]!);
    console.log(`${kind}: ${tracked} of ${frames} pictures tracked, ATE ${(100 * rmse).toFixed(1)} cm, ${(100 / seconds).toFixed(1)} pictures/s, median ${ms.toFixed(1)} ms, ${((Date.now() - begin) / 1000).toFixed(0)} s in all; lens ${await page.textContent('#lens')}`);
    assert.ok(rmse < 0.1, `${rmse} m`); // which images are processed depends on the machine
    assert.ok(tracked > 0.7 * frames, `${tracked} of ${frames}`);
    // The tab is hidden and shown again.
    const other = await page.context().newPage();
    await other.goto('about:blank');
    await other.bringToFront();
    await page.waitForTimeout(1500);
    await page.bringToFront();
    const now = await page.evaluate(() => window.phone.counters.processed);
    await processed(page, now + 40);
    await page.tap('#stop');
    await page.waitForFunction(() => document.body.dataset.phase === 'ended');
    await page.tap('#save-open');
    const saved = page.waitForEvent('download');
    await page.click('#files button:has-text("map.alidade")');
    const file = join(folder, `${kind}.alidade`);
    await (await saved).saveAs(file);
    assert.match(execFileSync(program, ['info', file], { encoding: 'utf8' }), /keyframes/);
    assert.deepEqual(problems, []);
    await page.context().close();
  });
}

const both = existsSync(join(WEB, 'core/dist/threads/alidade.wasm'));
test('the module with threads, working with one, says the same to the last byte', { ...options, skip: lacks || (!both && 'scripts/wasm/build threads has not been run') }, async () => {
  const count = 200;
  const site = await startSite(true, Object.fromEntries(recording.files.slice(0, count).map((file, i) => [`${i}.jpg`, file])));
  const { page, problems } = await open(browser, site.address, PHONE);
  const told = await page.evaluate(([frames, times]) => Promise.all(['single', 'threads'].map((variant) => new Promise<string>((resolve, reject) => {
    const worker = new Worker('worker.js', { type: 'module' });
    let next = 0;
    const push = async () => {
      const bitmap = await createImageBitmap(await (await fetch(`${next}.jpg`)).blob());
      worker.postMessage({ kind: 'picture', number: next, time: times[next], bitmap, turn: 0 });
      ++next;
    };
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if (data.kind === 'failed') reject(new Error(data.error));
      else if (data.kind === 'answer') resolve(new TextDecoder().decode(data.bytes));
      else if (next < frames) void push();
      else worker.postMessage({ kind: 'ask', what: 'trajectory' });
    };
    worker.postMessage({ kind: 'start', base: new URL(`core/${variant}/`, location.href).href, threads: 1, width: 400, height: 300, fov: 62.5, settings: {} });
  }))), [count, recording.times] as const);
  assert.ok(told[0]!.split('\n').length > 100, told[0]!.slice(0, 200));
  assert.equal(told[1], told[0]);
  assert.deepEqual(problems, []);
  await page.context().close();
  await site.close();
});

test('a cube is put on a tapped surface', options, async () => {
  const { page, problems } = await open(browser, sites.plain.address, { ...PHONE, permissions: ['camera'] });
  await page.tap('#start');
  await page.waitForFunction(() => document.body.dataset.state === 'tracking' && window.phone.state.landmarks.size > 300, undefined, { timeout: 60e3 });
  // A map that is restarted during self-calibration takes the cube with it, so the page looks and removes it within the
  // event of the tap. A busy machine may lose the camera: repeat the tap until there is a cube.
  await page.evaluate(() => {
    document.getElementById('picture')!.addEventListener('pointerup', () => {
      if (window.phone.cube === null) return;
      const remove = document.getElementById('remove')!;
      const offered = remove.getBoundingClientRect().width > 0;
      remove.click();
      window.placed = { offered, removed: window.phone.cube === null && remove.hidden };
    });
  });
  for (let i = 0; i < 150 && !(await page.evaluate(() => window.placed)); ++i) {
    const box = (await page.locator('#picture').boundingBox())!;
    await page.touchscreen.tap(box.x + box.width * (0.3 + 0.02 * (i % 20)), box.y + box.height * 0.55);
    await page.waitForTimeout(200);
  }
  assert.deepEqual(await page.evaluate(() => window.placed), { offered: true, removed: true });
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('a camera that is refused is told of, and what to do', options, async () => {
  const { page } = await open(refusing, sites.plain.address, PHONE);
  await page.tap('#start');
  await page.waitForSelector('#notice:not([hidden])');
  assert.match((await page.textContent('#notice'))!, /denied.*Start again/);
  assert.equal(await page.getAttribute('body', 'data-phase'), 'idle');
  await page.context().close();
});

test('opened once, it works without a network', options, async () => {
  const site = await startSite(true);
  const { page } = await open(browser, site.address, { ...PHONE, permissions: ['camera'] });
  await page.tap('#start');
  await processed(page, 5);
  await page.waitForFunction(() => document.body.dataset.offline === 'ready');
  await page.reload(); // through the service worker, so that the core is cached
  await page.tap('#start');
  await processed(page, 5);
  await site.close();
  await page.reload();
  const before = Date.now();
  await page.tap('#start');
  await processed(page, 1);
  console.log(`from a tap to the first picture worked on, all from the cache: ${Date.now() - before} ms`);
  await processed(page, 60);
  await page.waitForFunction(() => document.body.dataset.state === 'tracking', undefined, { timeout: 60e3 });
  await page.context().close();
});

test('what was recorded is a folder that the program runs', options, async () => {
  const { page, problems } = await open(browser, sites.plain.address, { ...PHONE, permissions: ['camera'] });
  await page.tap('#start');
  await processed(page, 10);
  await page.tap('#record');
  // Images that arrive while one is being written are not recorded, so wait for the number of recorded images.
  await page.waitForFunction(() => Number(/\d+/.exec(document.getElementById('record')!.textContent!)) >= 60, undefined, { timeout: 120e3 });
  const saved = page.waitForEvent('download');
  await page.tap('#record');
  const archive = join(folder, 'recording.zip');
  await (await saved).saveAs(archive);
  execFileSync('python3', ['-m', 'zipfile', '-e', archive, join(folder, 'recording')]);
  const [name] = execFileSync('ls', [join(folder, 'recording')], { encoding: 'utf8' }).trim().split('\n');
  const result = JSON.parse(readFileSync((execFileSync(program, ['run', join(folder, 'recording', name!), '--sensor', 'mono', '--fov', '62.5', '--out', join(folder, 'result'), '--quiet']), join(folder, 'result/stats.json')), 'utf8')) as { frames: number; tracked: number };
  assert.ok(result.frames > 40 && result.tracked > 0.5 * result.frames, `${result.tracked} of ${result.frames} frames tracked`);
  assert.deepEqual(problems, []);
  await page.context().close();
});

const video = join(process.env.ALIDADE_DATA ?? '', 'wild', 'drone_wall.mp4');
test('a video that is dropped in is worked through, picture by picture', { ...options, skip: lacks || (!existsSync(video) && `no ${video}`) }, async () => {
  const { page, problems } = await open(browser, sites.plain.address, PHONE);
  await page.setInputFiles('#file', video);
  await page.waitForFunction(() => document.body.dataset.phase === 'ended', undefined, { timeout: 200e3 });
  const seen = await page.evaluate(() => window.phone.counters.processed);
  execFileSync(program, ['run', video, '--sensor', 'mono', '--no-calibrate-first', '--profile', 'phone', '--out', join(folder, 'video'), '--quiet']);
  const { frames } = JSON.parse(readFileSync(join(folder, 'video/stats.json'), 'utf8')) as { frames: number };
  console.log(`${seen} of ${frames} pictures of the video`);
  assert.equal(seen, frames);
  assert.equal(Number(await page.textContent('[data-count=frames]')), frames);
  assert.equal(await page.getAttribute('body', 'data-state'), 'ended');
  assert.deepEqual(problems, []);
  await page.context().close();
});
