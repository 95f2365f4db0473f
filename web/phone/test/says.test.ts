// What the page says about where images go and what is kept is true, in each mode. Needs neither the core nor recordings.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { launch, open, SKIP } from '../../shared/test/browser.ts';
import { endAll, NO_PROGRAM, start } from '../../shared/test/program.ts';
import { startSite } from './server.ts';

declare const WEB: string;

const page = { skip: SKIP || (existsSync(join(WEB, 'phone/dist/index.html')) ? false : 'the page was not built'), timeout: 120e3 };
const program = { skip: NO_PROGRAM as string | false, timeout: 120e3 };
const PHONE = { viewport: { width: 412, height: 915 }, isMobile: true, hasTouch: true, permissions: ['camera'], serviceWorkers: 'block' as const };
const LOCAL = /stay on this device\W+nothing is uploaded/i;
const SENT = /sent to the computer that serves this page \(127\.0\.0\.1:\d+\)/;

let folder = '';
let browser: Browser;

before(async () => {
  if (SKIP) return;
  folder = mkdtempSync(join(tmpdir(), 'alidade-says-'));
  browser = await launch(['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream']);
});
after(async () => {
  await browser?.close();
  await endAll();
  if (folder) rmSync(folder, { recursive: true });
});

const choosing = (connected: boolean) => async (opened: Page) => {
  await opened.addInitScript((value) => { localStorage.setItem('alidade-phone', JSON.stringify({ connected: value })); }, connected);
};
const welcome = async (opened: Page) => {
  await opened.waitForSelector('#start:enabled');
  return (await opened.textContent('#welcome'))!;
};

for (const [info, chosen, sent] of [
  [{ connected: false, core: true }, false, false],
  [{ connected: false, core: true }, true, false], // chosen once, but this server does not offer it
  [{ connected: true, core: true }, false, false],
  [{ connected: true, core: true }, true, true],
  [{ connected: true, core: false }, false, true],
] as const) {
  test(`where the images go, before the camera starts: ${JSON.stringify({ ...info, chosen })}`, page, async () => {
    const site = await startSite(true, {}, info);
    const { page: opened } = await open(browser, site.address, PHONE, choosing(chosen));
    const text = await welcome(opened);
    assert.match(text, sent ? SENT : LOCAL);
    assert.doesNotMatch(text, sent ? LOCAL : SENT);
    await opened.context().close();
    await site.close();
  });
}

test('the choice changes the words at once', page, async () => {
  const site = await startSite(true, {}, { connected: true });
  const { page: opened } = await open(browser, site.address, PHONE);
  assert.match(await welcome(opened), LOCAL);
  await opened.tap('#settings-open');
  await opened.setChecked('#set-connected', true);
  await opened.locator('#settings form button').click();
  assert.match(await welcome(opened), SENT);
  await opened.context().close();
  await site.close();
});

test('nothing is promised before the server has said what it does', page, async () => {
  const site = await startSite(true, {}, { connected: true, core: false });
  let answer = () => {};
  const held = new Promise<void>((resolve) => { answer = resolve; });
  const { page: opened } = await open(browser, site.address, PHONE, async (before) => {
    await before.route('**/info.json*', async (route) => {
      await held;
      await route.continue();
    });
  });
  assert.doesNotMatch((await opened.textContent('#welcome'))!, /upload|stay on this device/);
  assert.equal(await opened.isEnabled('#start'), false);
  assert.equal(await opened.isEnabled('#file'), false);
  answer();
  assert.match(await welcome(opened), SENT);
  await opened.context().close();
  await site.close();
});

test('the program with --connected and without', program, async () => {
  // Only whether the files are there matters: the core is not started.
  const core = join(folder, 'core/single');
  mkdirSync(core, { recursive: true });
  for (const name of ['alidade.mjs', 'alidade.wasm']) writeFileSync(join(core, name), '');
  for (const connected of [false, true]) {
    const { address, kill } = await start('phone', '--port', '0', '--core', join(folder, 'core'), ...(connected ? ['--connected'] : []));
    const { page: opened } = await open(browser, address, PHONE, choosing(true));
    const text = await welcome(opened);
    assert.match(text, connected ? SENT : LOCAL);
    assert.doesNotMatch(text, connected ? LOCAL : SENT);
    await opened.context().close();
    kill('SIGTERM');
  }
});
