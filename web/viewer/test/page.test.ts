// Tests the page in a real browser with the sample's stream: compares what is drawn with the sample.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Browser } from 'playwright-core';
import type { LayerName } from '@alidade/scene';
import { CHROMIUM, count, differing, frames, launch, open, sceneOnly, SKIP, violations } from '../../shared/test/browser.ts';
import { encode } from '../../scene/test/encode.ts';
import { startServer } from './server.ts';
import type { Server, ServerSettings } from './server.ts';

const options = { skip: SKIP, timeout: 120e3 };
const SMALL = { frames: 300, depthPoints: 200, landmarks: 2500 };

let browser: Browser;
const servers: Server[] = [];

before(async () => { if (!SKIP) browser = await launch(); });
after(async () => {
  await browser?.close();
  await Promise.all(servers.map((server) => server.close()));
});

async function serve(settings: ServerSettings): Promise<Server> {
  const server = await startServer(settings);
  servers.push(server);
  return server;
}

// The page's internal state, exposed for tests.
interface Debug {
  state: {
    keyframes: Map<number, { T_world_camera: number[]; scale: number }>;
    landmarks: { size: number };
    landmarkInWorld(id: number): number[] | undefined;
    path: { length: number };
    frame: { number: number } | null;
  };
  player: { history: { frames: unknown[]; events: unknown[] } };
  project(p: readonly number[]): { x: number; y: number } | null;
  scene: { fit(): void };
}
declare global { interface Window { alidade: Debug } }

test(`frames come and counts rise (${CHROMIUM})`, options, async () => {
  const server = await serve({ sample: { ...SMALL, frames: 900 } });
  const { page, problems, requests } = await open(browser, server.address + '?token=abc');
  await frames(page, 40);
  const first = { keyframes: await count(page, 'keyframes'), landmarks: await count(page, 'landmarks'), frames: await count(page, 'frames') };
  assert.ok(first.keyframes >= 2 && first.landmarks > 100 && await count(page, 'matches') > 20);
  assert.equal(await page.getAttribute('body', 'data-state'), 'tracking');
  await frames(page, first.frames + 60);
  assert.ok(await count(page, 'keyframes') > first.keyframes && await count(page, 'landmarks') > first.landmarks);
  assert.deepEqual(problems, []);
  assert.ok(requests.every((url) => url.startsWith(server.address) || url.startsWith('blob:') || url.startsWith('ws:')), requests.join());
  await page.context().close();
});

test('every layer is drawn, and is not when it is switched off', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0, start: 230 });
  const { page, problems } = await open(browser, server.address);
  server.advance(1);
  await frames(page, 231);
  await page.keyboard.press('2');
  await page.keyboard.press('f');
  await page.waitForTimeout(1500);
  const names: LayerName[] = ['path', 'keyframes', 'landmarks', 'cloud', 'covisibility', 'loops', 'truth', 'camera'];
  const set = (name: string, on: boolean) => page.setChecked(`[data-layer=${name}]`, on);
  for (const name of names) await set(name, false);
  const empty = await sceneOnly(page);
  const [r, g, b] = empty.at(5, 5);
  for (let y = 0; y < empty.height; y += 7) for (let x = 0; x < empty.width; x += 7) assert.deepEqual(empty.at(x, y), [r, g, b]);
  for (const name of names) {
    await set(name, true);
    const seen = differing(await sceneOnly(page), empty);
    assert.ok(seen > 60, `${name}: ${seen} pixels`);
    await set(name, false);
  }
  assert.equal(differing(await sceneOnly(page), empty), 0);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('landmarks are drawn where they are: a dot within 2 pixels of each, nothing where there is none', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0, start: 120 });
  const { page } = await open(browser, server.address);
  server.advance(1);
  await frames(page, 121);
  for (const name of ['path', 'keyframes', 'cloud', 'loops', 'truth', 'camera']) await page.setChecked(`[data-layer=${name}]`, false);
  for (const view of ['2', '3']) {
    await page.keyboard.press(view);
    await page.keyboard.press('f');
    await page.waitForTimeout(1500);
    const picture = await sceneOnly(page);
    // Computed by the sample, not by the page.
    const world = [...server.sample.points.keys()].map((id) => server.sample.worldOf(id));
    const at = await page.evaluate((points) => points.map((p) => window.alidade.project(p)), world);
    const ground = picture.at(2, 2);
    const dotted = (x: number, y: number) => {
      for (let dy = -2; dy <= 2; ++dy) for (let dx = -2; dx <= 2; ++dx) {
        const [px, py] = [Math.round(x) + dx, Math.round(y) + dy];
        if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
        if (picture.at(px, py).some((value, k) => Math.abs(value - ground[k]) > 12)) return true;
      }
      return false;
    };
    const inside = at.filter((p) => p && p.x > 5 && p.y > 5 && p.x < picture.width - 6 && p.y < picture.height - 6) as { x: number; y: number }[];
    assert.ok(inside.length > 300, `${inside.length}`);
    assert.equal(inside.filter((p) => !dotted(p.x, p.y)).length, 0);
    // No other dots: positions far from all landmarks are empty.
    let stray = 0;
    for (let y = 10; y < picture.height; y += 11) for (let x = 10; x < picture.width; x += 11) {
      if (inside.every((p) => Math.hypot(p.x - x, p.y - y) > 6) && dotted(x, y)) ++stray;
    }
    assert.ok(stray <= 3, `${stray}`); // landmarks at the border
  }
  await page.context().close();
});

test('the camera picture shows what became of features, boxes and outlines, each as long as it is wanted', options, async () => {
  const server = await serve({ sample: { ...SMALL, pictures: false }, speed: 0, start: 149 });
  const { page, problems } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  server.advance(1);
  await frames(page, 150);
  const uses = [0, 0, 0, 0];
  const { features, detections, outlines } = server.sample.told!;
  for (let at = 4; at < features.length; at += 6) ++uses[features[at]];
  assert.ok(detections.length === 1 && outlines.length === 1 && uses[1] > 20 && uses[3] > 3, `${uses}`);
  for (const [use, name] of ['free', 'matched', 'fresh', 'moving'].entries()) assert.equal(await page.textContent(`#use-${name}`), String(uses[use]));
  assert.equal(await page.textContent('#use-things'), '1');
  assert.equal(await page.textContent('#things-age'), '0.3 s ago'); // from 0.25
  // Number of canvas pixels that differ from an empty canvas; the kinds of marks are drawn one at a time.
  const pixels = () => page.evaluate(() => {
    const canvas = document.getElementById('picture-canvas') as HTMLCanvasElement;
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true })!;
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 3; i < data.length; i += 4) count += Number(data[i] > 0);
    return { count, all: canvas.width * canvas.height, box: [...copy.getImageData(Math.round((215 * canvas.width) / 320), Math.round((200 * canvas.height) / 240), 1, 1).data] };
  });
  const marks = ['matched', 'fresh', 'free', 'moving', 'things'];
  for (const mark of marks) await page.click(`[data-mark=${mark}]`);
  assert.equal((await pixels()).count, 0);
  for (const mark of marks) {
    await page.click(`[data-mark=${mark}]`);
    assert.equal(await page.getAttribute(`[data-mark=${mark}]`, 'aria-pressed'), 'true');
    const { count, all } = await pixels();
    const told = mark === 'things' ? 1 : uses[['free', 'matched', 'fresh', 'moving'].indexOf(mark)];
    assert.ok(told === 0 ? count === 0 : count > 2 * told && count < 0.3 * all, `${mark}: ${count} pixels`);
    await page.click(`[data-mark=${mark}]`);
  }
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('all maps are drawn, others than the one the camera is in faintly', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0, start: 120 });
  const { page, problems } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  server.advance(1);
  await frames(page, 121);
  for (const name of ['path', 'keyframes', 'cloud', 'covisibility', 'loops', 'truth', 'camera']) await page.setChecked(`[data-layer=${name}]`, false);
  await page.keyboard.press('2');
  await page.keyboard.press('f');
  await page.waitForTimeout(1500);
  assert.equal(await page.isVisible('[data-layer=others]'), false); // there is only one map
  const one = await sceneOnly(page);
  // Add another map: one keyframe with landmarks around the origin.
  const keyframe = { ...server.sample.keyframes.get(0)!, id: 5000, map: 7, parent: 0xffffffff, covisible: [], loops: [] };
  const landmarks = new DataView(new ArrayBuffer(20 * 400));
  for (let i = 0; i < 400; ++i) {
    landmarks.setUint32(20 * i, 900000 + i, true);
    landmarks.setUint32(20 * i + 4, 5000, true);
    [0.1 * (i % 20) - 1, 0.1 * Math.floor(i / 20) - 1, 1.5].forEach((value, k) => landmarks.setFloat32(20 * i + 8 + 4 * k, value, true));
  }
  server.send(encode({
    kind: 'map', version: 10n ** 6n, whole: false, keyframes: [keyframe], moves: [], landmarks, removedLandmarks: new Uint32Array(0), culled: [], depth: [], path: [], worlds: null,
  }));
  await page.waitForFunction(() => window.alidade.state.keyframes.has(5000));
  const two = await sceneOnly(page);
  assert.ok(differing(two, one) > 300, `${differing(two, one)}`);
  // Fainter: closer to the background than points of the first map.
  const ground = one.at(2, 2);
  const strength = (p: number[]) => Math.hypot(...p.map((value, k) => value - ground[k]));
  let full = 0;
  const more: number[] = []; // pixels that were background before
  for (let y = 0; y < one.height; ++y) for (let x = 0; x < one.width; ++x) {
    full = Math.max(full, strength(one.at(x, y)));
    if (strength(one.at(x, y)) === 0 && strength(two.at(x, y)) > 0) more.push(strength(two.at(x, y)));
  }
  const faint = more.filter((value) => value > 0.1 * full && value < 0.5 * full).length;
  // The view's animation stops when changes are no longer visible, so a few dots may be one pixel off.
  assert.ok(faint > 300 && faint > 0.9 * more.length, `${faint} of ${more.length}`);
  await page.setChecked('[data-layer=others]', false);
  assert.ok(differing(await sceneOnly(page), one) < 0.2 * faint);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('after a loop was closed the page has the poses of the map', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0 });
  const { page } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  server.advance(300);
  await frames(page, 300);
  const told = await page.evaluate(() => [...window.alidade.state.keyframes].map(([id, k]) => ({ id, T: [...k.T_world_camera], scale: k.scale })));
  assert.equal(told.length, server.sample.keyframes.size);
  for (const { id, T, scale } of told) {
    const keyframe = server.sample.keyframes.get(id)!;
    [...keyframe.T_world_camera, keyframe.scale].forEach((value, k) => assert.ok(Math.abs(value - [...T, scale][k]) < 1e-6));
  }
  const ids = [...server.sample.points.keys()];
  const places = await page.evaluate((list) => list.map((id) => window.alidade.state.landmarkInWorld(id)), ids);
  ids.forEach((id, i) => server.sample.worldOf(id).forEach((value, k) => assert.ok(Math.abs(value - places[i]![k]) < 1e-5, `landmark ${id}`)));
  assert.equal(await page.evaluate(() => window.alidade.state.landmarks.size), ids.length);
  await page.context().close();
});

test('going back shows an earlier state while the run goes on; then back to now', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0 });
  const { page, problems } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  server.advance(200);
  await frames(page, 200);
  const now = { keyframes: await count(page, 'keyframes'), landmarks: await count(page, 'landmarks') };
  await page.fill('#seek', '60');
  await page.waitForFunction(() => document.querySelector('[data-count=frames]')!.textContent === '61');
  assert.equal(await page.getAttribute('body', 'data-shown'), 'past');
  const then = { keyframes: await count(page, 'keyframes'), landmarks: await count(page, 'landmarks') };
  assert.ok(then.keyframes < now.keyframes && then.landmarks < now.landmarks && then.keyframes > 0);
  assert.equal(await page.evaluate(() => window.alidade.state.keyframes.size), then.keyframes);
  server.advance(20);
  await page.waitForTimeout(300);
  assert.equal(await count(page, 'frames'), 61);
  await page.keyboard.press('.');
  await page.waitForFunction(() => document.querySelector('[data-count=frames]')!.textContent === '62');
  await page.keyboard.press('l');
  await frames(page, 220);
  assert.equal(await page.getAttribute('body', 'data-shown'), 'now');
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('pause and single step ask the program', options, async () => {
  const server = await serve({ sample: SMALL });
  const { page } = await open(browser, server.address);
  await frames(page, 5);
  await page.click('#play');
  await page.waitForSelector('body.paused');
  const stood = server.frame();
  await frames(page, stood);
  await page.click('#step');
  await frames(page, stood + 1);
  assert.equal(server.frame(), stood + 1);
  await page.click('#play');
  await frames(page, stood + 5);
  assert.deepEqual(server.asked, ['pause', 'step', 'resume']);
  await page.context().close();
});

test('a program that ends is noticed; one that starts again is shown', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0 });
  const { page } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  server.advance(160);
  await frames(page, 160);
  await page.fill('#seek', '120'); // the user looks at the past and moves the view
  await page.waitForFunction(() => document.body.dataset.shown === 'past');
  await page.click('[data-view=orbit]');
  await server.close();
  await page.waitForSelector('#notice:not([hidden])');
  assert.match((await page.textContent('#notice'))!, /No connection/);
  assert.equal(await count(page, 'frames'), 121); // the received messages remain
  const again = await serve({ sample: { ...SMALL, seed: 5, pictures: false }, speed: 0, port: server.port });
  await page.waitForFunction(() => document.body.dataset.connection === 'open', undefined, { timeout: 30e3 });
  again.advance(20);
  await page.waitForFunction(() => document.querySelector('[data-count=frames]')!.textContent === '20');
  assert.equal(await page.isHidden('#notice'), true);
  assert.equal(await page.evaluate(() => window.alidade.state.path.length), 20);
  // Nothing of the old run remains: its past, events, image, map.
  assert.equal(await page.getAttribute('body', 'data-shown'), 'now');
  assert.equal(await page.evaluate(() => window.alidade.player.history.frames.length), 20);
  assert.equal(await page.evaluate(() => window.alidade.state.landmarks.size), again.sample.points.size);
  assert.deepEqual(await page.locator('#events .event span').allTextContents(), await page.evaluate(() => window.alidade.player.history.events.length).then((n) => [
    'Started: map 0 begins', 'Not started: the camera hardly moves'].slice(0, n)));
  assert.equal(await page.isVisible('#picture-none'), true);
  assert.equal(await page.isVisible('[data-mark=things]'), false);
  await page.context().close();
});

test('a message that cannot be read is told, and the page goes on', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0 });
  const { page, problems } = await open(browser, server.address);
  await page.waitForFunction(() => document.body.dataset.connection === 'open');
  server.advance(5);
  await frames(page, 5);
  server.send(new Uint8Array(100).fill(7));
  await page.waitForSelector('#notice:not([hidden])');
  assert.match((await page.textContent('#notice'))!, /could not be read/);
  server.advance(5);
  await frames(page, 10);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('a recorded stream is shown with its end, and played at any speed', options, async () => {
  const server = await serve({ mode: 'replay', sample: SMALL });
  const { page, problems } = await open(browser, server.address);
  await frames(page, 300);
  const end = await count(page, 'keyframes');
  await page.selectOption('#speed', '10');
  await page.click('#play');
  await page.waitForFunction(() => Number(document.querySelector('[data-count=frames]')!.textContent) < 200);
  assert.ok(await count(page, 'keyframes') < end);
  await frames(page, 300);
  await page.waitForSelector('body.paused');
  assert.equal(await count(page, 'keyframes'), end);
  await page.fill('#seek', '100');
  await page.waitForFunction(() => document.querySelector('[data-count=frames]')!.textContent === '101');
  assert.match((await page.textContent('#error'))!, /From the truth: .* RMSE/);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('without WebGL the page says so, and shows the rest', options, async () => {
  const server = await serve({ sample: SMALL });
  const { page } = await open(browser, server.address, {}, async (page) => void await page.addInitScript(() => {
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, kind: string, ...rest: unknown[]) {
      return kind.startsWith('webgl') ? null : real.call(this, kind as '2d', ...rest as []);
    } as never;
  }));
  await frames(page, 10);
  assert.match((await page.textContent('#notice'))!, /WebGL/);
  await page.context().close();
});

test('axe finds nothing serious: light, dark, narrow, with its dialogs', options, async () => {
  const server = await serve({ sample: SMALL, speed: 0 });
  for (const [width, colorScheme] of [[1280, 'light'], [1280, 'dark'], [412, 'light'], [412, 'dark']] as const) {
    const { page } = await open(browser, server.address, { viewport: { width, height: 860 }, colorScheme });
    await page.waitForFunction(() => document.body.dataset.connection === 'open');
    server.advance(20);
    await frames(page, server.frame());
    if (width < 700) await page.click('#panel-toggle');
    const run = async (what: string) => assert.deepEqual(await violations(page), [], `${what}, ${width}, ${colorScheme}`);
    await run('page');
    await page.click('#about-open');
    await run('about');
    await page.context().close();
  }
});
