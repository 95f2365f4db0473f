// The ruler in a real browser: a fake camera plays a rendered recording, a fake motion sensor its inertial readings. Meters
// become known, and the distances that are measured are those of the rendered depth.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser } from 'playwright-core';
import { readPng } from '../../scene/test/png.ts';
import { launch, open, violations } from '../../shared/test/browser.ts';
import { BINARY, NO_PROGRAM } from '../../shared/test/program.ts';
import { openRecording, writeY4m } from '../../shared/test/y4m.ts';
import type { Recording } from '../../shared/test/y4m.ts';
import { BEGIN, install, motionOf } from './fake_motion.ts';
import { startSite } from './server.ts';
import type { Site } from './server.ts';

declare const WEB: string;

const built = existsSync(join(WEB, 'core/dist/single/alidade.wasm'));
const options = { skip: NO_PROGRAM || (built ? false : 'scripts/wasm/build has not been run'), timeout: 240e3 };
const FRAMES = 240;
const RATE = 8; // images per second as played; they are stamped as rendered, 30 per second
const MEASURES = 40;
const [WIDTH, HEIGHT, FOV] = [400, 300, 62.7];
const PHONE = { viewport: { width: 412, height: 915 }, isMobile: true, hasTouch: true, deviceScaleFactor: process.env.ALIDADE_SCREENS ? 2 : 1, permissions: ['camera', 'accelerometer', 'gyroscope', 'magnetometer'] };
const keep = process.env.ALIDADE_SCREENS;

interface Measured { time: number; ends: [number, number][]; length: number; sigma: number }
interface Phone {
  shown: { time: number; frame: { state: string }; inertial: { metric: boolean; scaleSigma: number } | null } | null;
  state: { frame: { features: Uint8Array } | null };
  ends: [number, number][];
  measured: { length: number; sigma: number } | null;
  watch(hook: () => void): void;
}

const folder = mkdtempSync(join(tmpdir(), 'alidade-ruler-'));
let recording: Recording;
let browser: Browser;
let site: Site;

before(async () => {
  if (options.skip) return;
  if (keep) mkdirSync(keep, { recursive: true });
  execFileSync(BINARY, ['synth', 'desk', join(folder, 'desk'), '--frames', String(FRAMES), '--width', String(WIDTH), '--height', String(HEIGHT), '--seed', '2', '--imu', 'phone', '--quiet']);
  recording = openRecording(join(folder, 'desk'));
  writeY4m(join(folder, 'desk.y4m'), recording, recording.times.map((_, i) => i), true, RATE);
  browser = await launch(['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${join(folder, 'desk.y4m')}`]);
  site = await startSite(true);
});
after(async () => {
  await browser?.close();
  await site?.close();
  rmSync(folder, { recursive: true });
});

// Measures on each image between two features, by events on the image and the button.
function measuring([width, height, enough]: readonly [number, number, number]): void {
  const { phone } = window as unknown as { phone: Phone };
  const found: Measured[] = [];
  let tries = 0;
  Object.assign(window, { found });
  const picture = document.getElementById('picture') as HTMLCanvasElement;
  const tap = (x: number, y: number) => {
    const { left, top, width: w, height: h } = picture.getBoundingClientRect();
    const scale = Math.min(w / width, h / height);
    const event = { clientX: left + w / 2 + (x + 0.5 - width / 2) * scale, clientY: top + h / 2 + (y + 0.5 - height / 2) * scale, bubbles: true };
    picture.dispatchEvent(new PointerEvent('pointerup', event));
  };
  const features = () => {
    const { buffer, byteOffset, length } = phone.state.frame!.features;
    const view = new DataView(buffer, byteOffset, length);
    const all: [number, number][] = [];
    for (let at = 0; at + 6 <= length; at += 6) if (view.getUint8(at + 4) === 1) all.push([(view.getUint16(at, true) * width) / 65536 - 0.5, (view.getUint16(at + 2, true) * height) / 65536 - 0.5]);
    return all;
  };
  phone.watch(() => {
    if (!phone.shown?.inertial?.metric || phone.shown.frame.state !== 'tracking') return;
    const button = document.getElementById('measure')!;
    const { measured } = phone;
    if (measured) found.push({ time: phone.shown.time, ends: phone.ends, ...measured });
    if (found.length >= enough) return; // the last one stays
    const all = features().filter(([x, y]) => x > 20 && y > 40 && x < width - 20 && y < height - 20);
    const a = all[(37 * ++tries) % all.length];
    const far = all.filter(([x, y]) => a && Math.hypot(x - a[0], y - a[1]) > 0.25 * width);
    const b = far[(53 * tries) % far.length];
    if (!a || !b) return;
    if (button.getAttribute('aria-pressed') === 'true') button.click(); // anew
    button.click();
    tap(...a);
    tap(...b);
  });
}

const depths = new Map<number, ArrayLike<number>>();
type Vector = [number, number, number];
// What was rendered within two pixels of a pixel, in the camera's frame: of a corner it is not known to the pixel on which
// side it is.
function around(number: number, [u, v]: [number, number]): Vector[] {
  const name = readFileSync(join(folder, 'desk/depth.txt'), 'utf8').split('\n').filter((line) => line && !line.startsWith('#'))[number]!.split(' ')[1]!;
  if (!depths.has(number)) depths.set(number, readPng(readFileSync(join(folder, 'desk', name))).samples);
  const focal = WIDTH / (2 * Math.tan((FOV * Math.PI) / 360));
  return [-2, 0, 2].flatMap((dy) => [-2, 0, 2].map((dx): Vector => {
    const z = depths.get(number)![WIDTH * Math.round(v + dy) + Math.round(u + dx)]! / 5000;
    return [((u - (WIDTH - 1) / 2) / focal) * z, ((v - (HEIGHT - 1) / 2) / focal) * z, z];
  }));
}

test('meters become known, and the ruler measures what was rendered', options, async () => {
  const { page, problems } = await open(browser, site.address, PHONE, async (opened) => {
    await opened.addInitScript((fov) => { localStorage.setItem('alidade-phone', JSON.stringify({ fov })); }, FOV);
    await install(opened, motionOf(join(folder, 'desk'), recording.times));
  });
  await page.tap('#start');
  await page.waitForSelector('#measure:visible');
  await page.tap('#measure');
  await page.waitForFunction(() => document.getElementById('state-word')!.textContent === 'Tracking');
  assert.match((await page.textContent('#advice'))!, /^Lengths are not known yet: move/);
  if (keep) await page.screenshot({ path: join(keep, 'ruler-before.png') });
  await page.tap('#measure');
  await page.evaluate(measuring, [WIDTH, HEIGHT, MEASURES] as const);
  await page.waitForFunction((enough) => (window as unknown as { found: unknown[] }).found.length >= enough || document.body.dataset.played === 'yes', MEASURES, { timeout: 120e3 });
  await page.waitForTimeout(100);
  if (keep) await page.screenshot({ path: join(keep, 'ruler.png') });
  const advice = await page.textContent('#advice');
  const lens = await page.textContent('#lens');
  const { found, told } = await page.evaluate(() => ({ found: (window as unknown as { found: Measured[] }).found, told: (window as unknown as { phone: Phone }).phone.shown!.inertial! }));
  const all = found.flatMap(({ time, ends, length, sigma }) => {
    const number = Math.round(30 * (time - BEGIN));
    const [at, to] = ends.map((end) => around(number, end));
    const truths = at!.flatMap((p) => to!.map((q) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2])));
    const [least, most] = [Math.min(...truths), Math.max(...truths)];
    if (most - least > 0.06 * most || !Number.isFinite(sigma)) return []; // on an edge, or said not to be known
    const truth = (least + most) / 2;
    return [{ number, truth, length, sigma, off: Math.abs(length - truth) }];
  });
  const sorted = (of: (one: (typeof all)[number]) => number) => all.map(of).sort((p, q) => p - q);
  const share = (of: (one: (typeof all)[number]) => boolean) => all.filter(of).length / all.length;
  const relative = sorted(({ off, truth }) => off / truth);
  console.log(`${found.length} distances, ${all.length} not on edges: off by ${(100 * relative[all.length >> 1]!).toFixed(1)} % (median), ${(100 * share(({ off, sigma }) => off < 3 * sigma)).toFixed(0)} % within 3 sigma, `
    + `${(100 * share(({ off, sigma }) => off < sigma)).toFixed(0)} % within 1; scale ± ${(100 * told.scaleSigma).toFixed(1)} %; images ${all[0]?.number} to ${all.at(-1)?.number}; ${advice} ${lens}`);
  assert.ok(told.metric && told.scaleSigma < 0.05);
  assert.ok(all.length >= 8, `${all.length} of ${found.length}`);
  assert.ok(relative[all.length >> 1]! < 0.05, 'off by more than 5 %');
  assert.ok(share(({ off, sigma }) => off < 3 * sigma) > 0.85, 'more than 3 sigma off');
  assert.match(lens!, /^Path \d+\.\d m ± \d+ % · Field of view/);
  assert.deepEqual((await violations(page)).filter((text) => /^(serious|critical)/.test(text)), []);
  assert.deepEqual(problems, []);
  await page.context().close();
});
