// The page at a phone's size, in light and dark, in every state: nothing is cut off or covered, and axe reports no
// serious problem. ALIDADE_SCREENS=FOLDER stores screenshots. The scenes are rendered.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { launch, open, violations } from '../../shared/test/browser.ts';
import { BINARY, endAll, NO_PROGRAM, start } from '../../shared/test/program.ts';
import { startSite } from './server.ts';
import type { Site } from './server.ts';
import { DARK, openRecording, writeY4m } from '../../shared/test/y4m.ts';

declare const WEB: string;

const built = existsSync(join(WEB, 'core/dist/single/alidade.wasm'));
const options = { skip: NO_PROGRAM || (built ? false : 'scripts/wasm/build has not been run'), timeout: 300e3 };
const onProgram = { skip: NO_PROGRAM as string | false, timeout: 300e3 };
const FRAMES = 100;
const SIZE = { width: 412, height: 915 };
const keep = process.env.ALIDADE_SCREENS;

const folder = mkdtempSync(join(tmpdir(), 'alidade-looks-'));
let site: Site;
let walking: Browser; // camera moves through a room forwards and backwards
let losing: Browser; // camera moves through a room, then into the dark
let still: Browser; // camera does not move
let refusing: Browser;

before(async () => {
  if (NO_PROGRAM) return;
  if (keep) mkdirSync(keep, { recursive: true });
  const room = join(folder, 'room');
  execFileSync(BINARY, ['synth', 'room', room, '--frames', String(FRAMES), '--width', '640', '--height', '480', '--quiet']);
  const recording = openRecording(room);
  const there = Array.from({ length: FRAMES }, (_, i) => i);
  const camera = (name: string, order: readonly number[]) => {
    const file = join(folder, `${name}.y4m`);
    writeY4m(file, recording, order, false);
    return launch(['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${file}`]);
  };
  walking = await camera('walking', [...there, ...there.slice(1, -1).reverse()]);
  losing = await camera('losing', [...there, ...Array.from({ length: 300 }, () => DARK)]);
  still = await camera('still', [0, 0]);
  refusing = await launch(['--deny-permission-prompts', '--use-fake-device-for-media-stream']);
  site = await startSite(true);
});
after(async () => {
  for (const browser of [walking, losing, still, refusing]) await browser?.close();
  await site?.close();
  await endAll();
  rmSync(folder, { recursive: true, force: true });
});

const phone = (scheme: 'light' | 'dark', size = SIZE) =>
  ({ viewport: size, isMobile: true, hasTouch: true, deviceScaleFactor: 2, colorScheme: scheme, permissions: ['camera'] });

// Elements that reach beyond the screen, or whose text is cut off.
const cutOff = (page: Page) => page.evaluate(() => {
  const found: string[] = [];
  const dialog = document.querySelector('dialog[open]');
  for (const element of (dialog ?? document.body).querySelectorAll<HTMLElement>('button, .button, p, h2, #status, dd, dt, li, input, textarea')) {
    const box = element.getBoundingClientRect();
    if (box.width < 2 || box.height < 2 || element.closest('.unseen')) continue;
    const scrolls = element.closest('dialog, #bar');
    const name = element.id || element.textContent!.trim().slice(0, 30);
    if (box.left < -0.5 || box.right > innerWidth + 0.5) found.push(`${name} reaches from ${box.left} to ${box.right}`);
    if (!scrolls && (box.top < -0.5 || box.bottom > innerHeight + 0.5)) found.push(`${name} reaches from ${box.top} to ${box.bottom}`);
    if (element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).overflowX === 'hidden') found.push(`${name} is cut`);
  }
  return found;
});

// Visible buttons whose center is covered by another element.
const covered = (page: Page) => page.evaluate(() => [...(document.querySelector('dialog[open]') ?? document.body).querySelectorAll<HTMLElement>('button, label.button')].filter((button) => {
  const box = button.getBoundingClientRect();
  if (box.width < 2 || box.height < 2 || box.bottom > innerHeight || box.top < 0) return false;
  const top = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
  return !(top && (button.contains(top) || top.contains(button) && top !== document.body));
}).map((button) => button.id || button.textContent!));

async function look(page: Page, name: string): Promise<void> {
  if (keep) await page.screenshot({ path: join(keep, `${name}.png`) });
  assert.deepEqual(await cutOff(page), [], name);
  assert.deepEqual(await covered(page), [], name);
  assert.deepEqual((await violations(page)).filter((text) => /^(serious|critical)/.test(text)), [], name);
}

const state = (page: Page, word: string) => page.waitForFunction((w) => document.body.dataset.state === w, word, { timeout: 120e3 });
const close = async (page: Page) => page.locator('dialog[open] form button').click();

async function settings(page: Page, scheme: string): Promise<void> {
  await page.tap('#settings-open');
  await look(page, `${scheme}-settings`);
  await page.locator('#settings summary').tap();
  await page.locator('#settings a').scrollIntoViewIfNeeded();
  await look(page, `${scheme}-settings-more`);
  await close(page);
}

for (const scheme of ['light', 'dark'] as const) {
  test(`welcome, settings, a camera refused: ${scheme}`, onProgram, async () => {
    const { page } = await open(refusing, site.address, { ...phone(scheme), permissions: [] });
    await look(page, `${scheme}-welcome`);
    await settings(page, scheme);
    await page.tap('#start');
    await page.waitForSelector('#notice:not([hidden])');
    await look(page, `${scheme}-refused`);
    await page.context().close();
  });

  test(`starting, in a camera that stands still: ${scheme}`, options, async () => {
    const { page } = await open(still, site.address, phone(scheme));
    await page.tap('#start');
    await page.waitForFunction(() => window.phone.counters.processed > 20, undefined, { timeout: 60e3 });
    assert.equal(await page.getAttribute('body', 'data-state'), 'initializing');
    await look(page, `${scheme}-starting`);
    await page.context().close();
  });

  test(`tracking, a cube, saving, the end: ${scheme}`, options, async () => {
    const { page } = await open(walking, site.address, phone(scheme), async (opened) => {
      await opened.addInitScript(() => { localStorage.setItem('alidade-phone', JSON.stringify({ shape: true })); });
    });
    await page.tap('#start');
    await page.waitForFunction(() => document.body.dataset.state === 'tracking' && window.phone.state.keyframes.size > 6, undefined, { timeout: 120e3 });
    await look(page, `${scheme}-tracking`);
    for (let i = 0; i < 30 && !(await page.evaluate(() => window.phone.cube !== null)); ++i) {
      const box = (await page.locator('#picture').boundingBox())!;
      await page.touchscreen.tap(box.x + box.width * (0.3 + 0.013 * i), box.y + box.height * (0.5 + 0.005 * i));
      await page.waitForTimeout(200);
    }
    assert.ok(await page.evaluate(() => window.phone.cube !== null));
    await page.waitForFunction(() => document.getElementById('notice')!.hidden);
    await look(page, `${scheme}-cube`);
    await page.tap('[data-view=orbit]');
    await page.tap('#record');
    await page.waitForTimeout(600);
    await look(page, `${scheme}-orbit-recording`);
    await page.setViewportSize({ width: 915, height: 412 });
    await page.waitForTimeout(600);
    await look(page, `${scheme}-lying`);
    await page.setViewportSize(SIZE);
    await page.tap('#stop');
    await page.tap('#save-open');
    await look(page, `${scheme}-save`);
    await close(page);
    await look(page, `${scheme}-ended`);
    await page.context().close();
  });

  test(`lost in the dark: ${scheme}`, options, async () => {
    const { page } = await open(losing, site.address, phone(scheme));
    await page.tap('#start');
    await state(page, 'tracking');
    await state(page, 'lost');
    await page.waitForTimeout(1500); // until the predicted pose expires
    assert.match((await page.textContent('#advice'))!, /dark/);
    await look(page, `${scheme}-lost`);
    await page.context().close();
  });

  test(`connected, and the network gone: ${scheme}`, onProgram, async () => {
    const program = await start('phone', '--port', '0', '--connected');
    const { page } = await open(walking, program.address, phone(scheme), async (opened) => {
      await opened.addInitScript(() => { localStorage.setItem('alidade-phone', JSON.stringify({ connected: true })); });
    });
    await page.tap('#start');
    await page.waitForFunction(() => document.body.dataset.state === 'tracking' && window.phone.state.keyframes.size > 4, undefined, { timeout: 120e3 });
    await look(page, `${scheme}-connected`);
    program.kill('SIGKILL');
    await page.waitForSelector('#notice:not([hidden])');
    await look(page, `${scheme}-connection-lost`);
    await page.context().close();
  });
}
