// Tests the page with the real program: compares what the page shows with the program's files.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import type { State } from '@alidade/scene';
import { count, frames, launch, open, violations } from '../../shared/test/browser.ts';
import type { Opened } from '../../shared/test/browser.ts';
import { BINARY, endAll, inFolder, NO_PROGRAM, run, start, table } from '../../shared/test/program.ts';

const options = { skip: NO_PROGRAM, timeout: 600e3 };
const ROOM = 'synth:room?frames=150';
const LONG = 'synth:room?frames=600'; // not run to its end
// Stream/settings.h: landmarks are sent again when they moved by more than this share of the distance to their
// keyframe.
const LANDMARK_MOVED = 0.001;
const DATA = process.env.ALIDADE_DATA;

let browser: Browser;
let recorded = ''; // folder of a run that was watched and recorded

before(async () => { if (!NO_PROGRAM) browser = await launch(); });
after(async () => {
  await browser?.close();
  await endAll();
});

// No errors and no requests to other hosts. The browser itself reports lost connections.
function assertClean({ problems, requests }: Opened, address: string): void {
  assert.deepEqual(problems.filter((text) => !/WebSocket connection to .* failed/.test(text)), []);
  const origin = new URL(address).origin;
  const own = (url: string) => url.startsWith(origin + '/') || url.startsWith(`blob:${origin}/`) || url.startsWith(origin.replace('http', 'ws') + '/');
  assert.deepEqual(requests.filter((url) => !own(url)), []);
}

// Number of distinct colors in the camera image; without an image only the features' colors. Counted on a readable
// copy.
const colours = (page: Page) => page.evaluate(() => {
  const canvas = document.getElementById('picture-canvas') as HTMLCanvasElement;
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true })!;
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  const seen = new Set<number>();
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] === 255) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
  return seen.size;
});

async function assertGrows(page: Page): Promise<void> {
  await frames(page, 10);
  await page.waitForFunction(() => document.body.dataset.state === 'tracking', undefined, { timeout: 120e3 });
  const before = { frames: await count(page, 'frames'), keyframes: await count(page, 'keyframes'), landmarks: await count(page, 'landmarks') };
  await page.waitForFunction((b) => {
    const of = (name: string) => Number(document.querySelector(`[data-count=${name}]`)!.textContent);
    return of('frames') > b.frames + 5 && of('keyframes') > b.keyframes && of('landmarks') > b.landmarks && of('matches') > 20;
  }, before, { timeout: 300e3 });
  await page.waitForFunction(() => (window as unknown as { alidade: { state: State } }).alidade.state.pictured !== null);
  await page.waitForTimeout(500);
  const seen = await colours(page);
  assert.ok(seen > 1000, `the camera picture has ${seen} colours`);
}

const stateWord = (page: Page) => page.textContent('#state-word');

test(`a run is watched: the same bytes as alone, and the page says when it is over (${BINARY})`, options, async () => {
  recorded = inFolder('watched');
  const program = await start('run', ROOM, '--viewer', '--port', '0', '--record', '--out', recorded);
  const opened = await open(browser, program.address);
  await assertGrows(opened.page);
  assert.equal(await program.ended, 0);
  await opened.page.waitForSelector('#notice:not([hidden])');
  assert.match((await opened.page.textContent('#notice'))!, /The program has ended/);
  assert.equal(await count(opened.page, 'frames'), 150);
  assert.equal(await stateWord(opened.page), 'Ended');
  assertClean(opened, program.address);
  await opened.page.context().close();
  await run('run', ROOM, '--quiet', '--out', inFolder('alone'));
  for (const name of ['trajectory.txt', 'keyframes.txt', 'map.alidade']) {
    assert.ok(readFileSync(join(recorded, name)).equals(readFileSync(join(inFolder('alone'), name))), name);
  }
});

const needsData = NO_PROGRAM || (DATA ? false : 'ALIDADE_DATA names no folder of recordings');
test('a real recording is watched', { ...options, skip: needsData }, async () => {
  const program = await start('run', join(DATA ?? '', 'kitchen'), '--sensor', 'rgbd', '--viewer', '--port', '0', '--out', inFolder('kitchen'));
  const opened = await open(browser, program.address);
  await assertGrows(opened.page);
  assertClean(opened, program.address);
  program.kill('SIGKILL');
  await opened.page.context().close();
});

interface Told { keyframes: { number: number; time: number; T: number[] }[]; landmarks: { p: number[]; away: number }[] }
const told = (page: Page): Promise<Told> => page.evaluate(() => {
  const { state } = (window as unknown as { alidade: { state: State } }).alidade;
  const keyframes = [...state.keyframes.values()].sort((a, b) => a.number - b.number);
  const landmarks: { p: number[]; away: number }[] = [];
  for (const page of state.landmarks.pages) {
    for (let at = 0; at < page.u32.length; at += 5) {
      const id = page.u32[at];
      const landmark = landmarks.length < state.landmarks.size ? state.landmarks.get(id) : undefined;
      if (!landmark) continue;
      const { scale } = state.keyframes.get(landmark.keyframe)!;
      landmarks.push({ p: [...state.landmarkInWorld(id)!], away: scale * Math.hypot(...landmark.p) });
    }
  }
  return { keyframes: keyframes.map(({ number, time, T_world_camera }) => ({ number, time, T: [...T_world_camera] })), landmarks };
});

// Compares with the files of the run.
function assertRight({ keyframes, landmarks }: Told, folder: string): void {
  const saved = table(join(folder, 'keyframes.txt'));
  assert.equal(keyframes.length, saved.length);
  keyframes.forEach(({ time, T }, i) => {
    const [at, ...pose] = saved[i];
    assert.ok(Math.abs(time - at) < 1e-5, `${time} is not ${at}`);
    // Q and -q are the same rotation.
    const sign = Math.sign(T[0] * pose[3] + T[1] * pose[4] + T[2] * pose[5] + T[3] * pose[6]);
    const page = [T[4], T[5], T[6], ...T.slice(0, 4).map((value) => sign * value)];
    page.forEach((value, k) => assert.ok(Math.abs(value - pose[k]) < 1e-6, `keyframe ${i}: ${page} is not ${pose}`));
  });
  const points = table(join(folder, 'landmarks.ply')).filter((row) => row.length >= 3);
  assert.equal(landmarks.length, points.length);
  for (const [x, y, z] of points) {
    const near = landmarks.some(({ p, away }) => Math.hypot(p[0] - x, p[1] - y, p[2] - z) <= 1.1 * LANDMARK_MOVED * away + 1e-6);
    assert.ok(near, `no landmark of the page is at ${x} ${y} ${z}`);
  }
}

test('a recorded run is replayed: its end is the saved map, what was before is there to go back to', options, async () => {
  const program = await start('view', recorded, '--port', '0');
  const opened = await open(browser, program.address);
  const { page } = opened;
  await page.waitForFunction(() => document.querySelector('[data-count=frames]')!.textContent === '150');
  await page.waitForFunction(() => document.getElementById('state-word')!.textContent === 'Ended');
  assertRight(await told(page), recorded);
  await page.waitForFunction(() => /From the truth/.test(document.getElementById('error')!.textContent ?? ''));
  const [keyframes, landmarks] = [await count(page, 'keyframes'), await count(page, 'landmarks')];
  const box = (await page.locator('#seek').boundingBox())!;
  await page.mouse.move(box.x + box.width - 8, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + box.height / 2, { steps: 10 });
  await page.mouse.up();
  await page.waitForFunction(() => Number(document.querySelector('[data-count=frames]')!.textContent) < 80);
  assert.equal(await page.getAttribute('body', 'data-shown'), 'past');
  assert.ok(await count(page, 'keyframes') < keyframes && await count(page, 'landmarks') < landmarks && await count(page, 'keyframes') > 0);
  assert.equal(await stateWord(page), 'Tracking');
  // The ground truth is known here as well, although a rendered recording sends it at its end.
  assert.equal(await page.evaluate(() => (window as unknown as { alidade: { state: State } }).alidade.state.hello!.truth.length), 150);
  assert.deepEqual(await violations(page), []);
  assertClean(opened, program.address);
  await page.context().close();
  program.kill('SIGINT');
});

test('a map alone is shown', options, async () => {
  const program = await start('view', join(recorded, 'map.alidade'), '--port', '0');
  const opened = await open(browser, program.address);
  await opened.page.waitForFunction(() => Number(document.querySelector('[data-count=landmarks]')!.textContent) > 0);
  assertRight(await told(opened.page), recorded);
  assert.equal(await stateWord(opened.page), 'Map');
  assertClean(opened, program.address);
  await opened.page.context().close();
  program.kill('SIGINT');
});

test('a program that was killed and started again at the same port is noticed, and the page goes on', options, async () => {
  const first = await start('run', LONG, '--viewer', '--port', '0', '--out', inFolder('first'));
  const opened = await open(browser, first.address);
  const { page } = opened;
  await frames(page, 20);
  first.kill('SIGKILL');
  await page.waitForSelector('#notice:not([hidden])');
  assert.match((await page.textContent('#notice'))!, /No connection/);
  assert.ok(await count(page, 'frames') >= 20); // the received messages remain
  await first.ended;
  const again = await start('run', LONG, '--viewer', '--port', String(first.port), '--out', inFolder('again'));
  assert.equal(again.port, first.port);
  await page.waitForFunction(() => document.body.dataset.connection === 'open', undefined, { timeout: 60e3 });
  await page.waitForSelector('#notice', { state: 'hidden' });
  await frames(page, 10);
  const from = await count(page, 'frames');
  await frames(page, from + 5);
  assertClean(opened, first.address);
  again.kill('SIGKILL');
  await page.context().close();
});

test('the program is paused, stepped and let go on', options, async () => {
  const program = await start('run', LONG, '--viewer', '--port', '0', '--out', inFolder('paused'));
  const opened = await open(browser, program.address);
  const { page } = opened;
  await frames(page, 5);
  await page.click('#play');
  await page.waitForSelector('body.paused');
  let stood = -1;
  // Until messages in flight have arrived.
  for (let now = await count(page, 'frames'); now !== stood; now = await count(page, 'frames')) {
    stood = now;
    await page.waitForTimeout(3000);
  }
  for (const more of [1, 2]) {
    await page.click('#step');
    await frames(page, stood + more);
    await page.waitForTimeout(1000);
    assert.equal(await count(page, 'frames'), stood + more);
  }
  await page.click('#play');
  await frames(page, stood + 8);
  assertClean(opened, program.address);
  program.kill('SIGKILL');
  await page.context().close();
});

test('the page comes with its policy', options, async () => {
  const program = await start('view', join(recorded, 'map.alidade'), '--port', '0');
  const { headers } = await fetch(program.address);
  const policy = headers.get('content-security-policy') ?? '';
  assert.match(policy, /default-src 'none'/);
  assert.doesNotMatch(policy, /'unsafe-|\*|https?:/);
  assert.equal(headers.get('x-content-type-options'), 'nosniff');
  program.kill('SIGINT');
  assert.equal(await program.ended, 0);
});
