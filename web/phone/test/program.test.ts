// `alidade phone` and the page: with the core in the page, or with images sent to the program; lost networks, ended
// programs, refused clients.
import assert from 'node:assert/strict';
import { existsSync, readdirSync, rmSync, mkdtempSync } from 'node:fs';
import { request } from 'node:http';
import { connect, createServer } from 'node:net';
import type { AddressInfo, Socket } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { WebSocket } from 'ws';
import { launch, open } from '../../shared/test/browser.ts';
import { endAll, NO_PROGRAM, start } from '../../shared/test/program.ts';
import { openRecording, writeY4m } from '../../shared/test/y4m.ts';

declare const WEB: string;

const kitchen = join(process.env.ALIDADE_DATA ?? '', 'kitchen');
const lacks = NO_PROGRAM || !(process.env.ALIDADE_DATA && existsSync(kitchen)) && 'ALIDADE_DATA does not point to the recordings' || false;
const options = { skip: lacks, timeout: 240e3 };
const core = join(WEB, 'core/dist');
const PHONE = { viewport: { width: 412, height: 915 }, isMobile: true, hasTouch: true, permissions: ['camera'], ignoreHTTPSErrors: true };

let folder = '';
let browser: Browser;

before(async () => {
  if (lacks) return;
  folder = mkdtempSync(join(tmpdir(), 'alidade-connected-'));
  const there = Array.from({ length: 200 }, (_, i) => i);
  writeY4m(join(folder, 'camera.y4m'), openRecording(kitchen), [...there, ...there.slice(1, -1).reverse()]);
  browser = await launch(['--use-fake-ui-for-media-stream', '--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${join(folder, 'camera.y4m')}`]);
});
after(async () => {
  await browser?.close();
  await endAll();
  if (folder) rmSync(folder, { recursive: true });
});

const connected = async (page: Page) => {
  await page.addInitScript(() => { localStorage.setItem('alidade-phone', JSON.stringify({ connected: true, fov: 62.5 })); });
};
const processed = (page: Page, more: number) => page.evaluate(() => window.phone.counters.processed).then((now) =>
  page.waitForFunction((n) => window.phone.counters.processed >= n, now + more, { timeout: 120e3 }));
const tracking = (page: Page) => page.waitForFunction(() => document.body.dataset.state === 'tracking' && window.phone.state.landmarks.size > 100, undefined, { timeout: 90e3 });
// Collects the numbers of the processed images.
const noting = (page: Page) => page.evaluate(() => {
  const numbers: number[] = [];
  Object.assign(window, { numbers });
  window.phone.watch(({ number }) => { numbers.push(number); });
});
const numbers = (page: Page) => page.evaluate(() => (window as unknown as { numbers: number[] }).numbers);

test('the program serves the page and the core, cross-origin isolated', { ...options, skip: lacks || !existsSync(join(core, 'single/alidade.wasm')) && 'scripts/wasm/build has not been run' }, async () => {
  const program = await start('phone', '--port', '0', '--core', core);
  const { page, problems } = await open(browser, program.address, PHONE);
  assert.equal(await page.evaluate(() => self.crossOriginIsolated), true);
  await page.tap('#start');
  await tracking(page);
  assert.deepEqual(problems, []);
  await page.context().close();
});

test('two pages send their pictures; the network goes and comes; each has a map of its own', options, async () => {
  const out = join(folder, 'maps');
  const program = await start('phone', '--port', '0', '--connected', '--out', out);
  const pages = await Promise.all([0, 1].map(async () => {
    const opened = await open(browser, program.address, PHONE, connected);
    await opened.page.tap('#start');
    await noting(opened.page);
    return opened;
  }));
  for (const { page } of pages) await tracking(page);
  const [one, two] = pages.map(({ page }) => page) as [Page, Page];
  const before = await one.evaluate(() => window.phone.state.keyframes.size);
  // One page loses its connection three times.
  for (let i = 0; i < 3; ++i) {
    await one.evaluate(() => (window.phone.engine as unknown as { socket: WebSocket }).socket.close());
    await one.waitForSelector('#notice:not([hidden])');
    await one.waitForSelector('#notice', { state: 'hidden' });
    await processed(one, 20);
  }
  await tracking(one);
  assert.ok(await one.evaluate(() => window.phone.state.keyframes.size) >= before, 'the map was lost');
  await processed(two, 20);
  for (const page of [one, two]) {
    const seen = await numbers(page);
    assert.equal(new Set(seen).size, seen.length, 'a picture was worked on twice');
    assert.deepEqual([...seen].sort((a, b) => a - b), seen);
  }
  for (const { page, problems } of pages) {
    assert.deepEqual(problems, []);
    await page.context().close();
  }
  program.kill('SIGINT');
  assert.equal(await program.ended, 0);
  assert.deepEqual(readdirSync(out).length, 2);
  for (const name of readdirSync(out)) assert.deepEqual(readdirSync(join(out, name)).sort(), ['landmarks.ply', 'map.alidade', 'trajectory.txt']);
});

// A proxy that can fall silent without closing connections, as a network does when a phone leaves its range.
async function network(to: number): Promise<{ port: number; cut(): void; heal(): void; close(): void }> {
  let silent = false;
  const sockets = new Set<Socket>();
  const server = createServer((near) => {
    const far = connect(to, '127.0.0.1');
    for (const [from, into] of [[near, far], [far, near]] as const) {
      sockets.add(from);
      from.on('data', (data) => {
        if (silent) return;
        // The program accepts requests to its own host name only.
        const asked = from === near && data.subarray(0, 4).toString('latin1') === 'GET ';
        into.write(asked ? data.toString('latin1').replaceAll(`127.0.0.1:${port}`, `127.0.0.1:${to}`) : data, asked ? 'latin1' : undefined);
      });
      from.on('close', () => { if (!silent) into.destroy(); });
      from.on('error', () => {});
    }
  });
  await new Promise<void>((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  const { port } = server.address() as AddressInfo;
  return {
    port,
    cut: () => { silent = true; },
    heal: () => { // interrupted connections stay interrupted
      for (const socket of sockets) socket.removeAllListeners('data').resume();
      sockets.clear();
      silent = false;
    },
    close: () => {
      for (const socket of sockets) socket.destroy();
      server.close();
    },
  };
}

test('a network that falls silent is seen to be gone, and gone on with once it is back', options, async () => {
  const program = await start('phone', '--port', '0', '--connected');
  const between = await network(program.port);
  const { page } = await open(browser, `http://127.0.0.1:${between.port}/`, PHONE, connected);
  await page.tap('#start');
  await noting(page);
  await tracking(page);
  const before = await page.evaluate(() => window.phone.state.keyframes.size);
  between.cut();
  await page.waitForSelector('#notice:not([hidden])', { timeout: 40e3 });
  assert.match((await page.textContent('#notice'))!, /No connection/);
  between.heal();
  await page.waitForSelector('#notice', { state: 'hidden', timeout: 60e3 });
  await processed(page, 20);
  await tracking(page);
  assert.ok(await page.evaluate(() => window.phone.state.keyframes.size) >= before, 'the map was lost');
  const seen = await numbers(page);
  assert.equal(new Set(seen).size, seen.length, 'a picture was worked on twice');
  await page.context().close();
  between.close();
});

test('a program that is killed and started again is gone on with', options, async () => {
  const first = await start('phone', '--port', '0', '--connected');
  const { page } = await open(browser, first.address, PHONE, connected);
  await page.tap('#start');
  await tracking(page);
  first.kill('SIGKILL');
  await first.ended;
  await page.waitForSelector('#notice:not([hidden])');
  assert.match((await page.textContent('#notice'))!, /No connection/);
  await start('phone', '--port', String(first.port), '--connected');
  await page.waitForSelector('#notice', { state: 'hidden', timeout: 30e3 });
  await processed(page, 30);
  await tracking(page);
  await page.context().close();
});

test('over TLS, too', options, async () => {
  const program = await start('phone', '--port', '0', '--tls', '--connected');
  assert.match(program.address, /^https:/);
  const { page } = await open(browser, program.address, PHONE, connected);
  assert.equal(await page.evaluate(() => isSecureContext), true);
  await page.tap('#start');
  await tracking(page);
  await page.context().close();
});

test('who may not is told so, and what is no picture harms nobody', options, async () => {
  const program = await start('phone', '--port', '0', '--connected', '--host', '0.0.0.0');
  const token = new URL(program.address).searchParams.get('token')!;
  const status = (path: string, headers: Record<string, string> = {}) => new Promise<number>((resolve, reject) => {
    request({ host: '127.0.0.1', port: program.port, path, headers }, (answer) => {
      answer.resume();
      resolve(answer.statusCode!);
    }).on('error', reject).end();
  });
  assert.equal(await status('/'), 403);
  assert.equal(await status(`/?token=${token}`), 200);
  assert.equal(await status(`/?token=${token}`, { Host: 'evil.example' }), 403);
  assert.equal(await status('/phone.js'), 200);
  for (const path of ['/core/../CMakeLists.txt', '/core/single/..%2f..%2fmain.cc', '/core/single/alidade.wasm.gz', '/core/', '/run.stream', '/viewer.js']) assert.equal(await status(path), 404, path);
  const dial = (query: string, headers: Record<string, string> = {}) => new WebSocket(`ws://127.0.0.1:${program.port}/frames${query}`, { headers });
  const refused = (socket: WebSocket) => new Promise<boolean>((resolve) => {
    socket.on('open', () => resolve(false));
    socket.on('error', () => resolve(true));
  });
  assert.ok(await refused(dial('')));
  assert.ok(await refused(dial(`?token=${token}`, { Origin: 'https://evil.example' })));
  // Sends a hello and further messages; resolves with all replies up to the reply to the last one, or when the
  // connection closes.
  const talk = (hello: string | Buffer, ...then: (string | Buffer)[]) => new Promise<string[]>((resolve) => {
    const socket = dial(`?token=${token}`);
    const told: string[] = [];
    socket.on('open', () => {
      socket.send(hello);
      for (const one of then) socket.send(one);
    });
    socket.on('message', (data, binary) => {
      if (!binary) told.push(String(data));
      if (told.length > then.length) socket.close();
    });
    socket.on('close', () => resolve(told));
    socket.on('error', () => resolve(told));
  });
  const hello = (session: string, width = 64, height = 48) => JSON.stringify({ session, width, height, fov: null });
  const name = (digit: string) => digit.repeat(32);
  assert.match((await talk('nonsense'))[0]!, /error.*JSON/);
  assert.match((await talk(Buffer.from([1, 2, 3])))[0]!, /error/);
  assert.match((await talk(hello('../../etc')))[0]!, /error.*32 hexadecimal/);
  assert.match((await talk(hello(name('a'), 100000, 100000)))[0]!, /error.*not accepted/);
  const frame = (number: number, bytes: Buffer) => {
    const head = Buffer.alloc(16);
    head.writeUInt32LE(number, 0);
    head.writeDoubleLE(number / 30, 8);
    return Buffer.concat([head, bytes]);
  };
  const garbage = await talk(hello(name('b')), frame(1, Buffer.from('no JPEG at all')));
  assert.match(garbage[0]!, /welcome/);
  assert.match(garbage[1]!, /skipped":true/);
  assert.match((await talk(hello(name('b')), frame(1, Buffer.from('again'))))[0]!, /"last":1.*"resumed":true/);
  assert.match((await talk(hello(name('b')), Buffer.alloc(4))).at(-1)!, /error/);
  await talk(hello(name('b')), frame(9, Buffer.alloc(5 << 20))); // too large: the connection is closed
  // At most four maps; one without a viewer is replaced.
  for (const digit of ['c', 'd', 'e', 'f', '0']) assert.match((await talk(hello(name(digit))))[0]!, /welcome/);
  assert.equal(await status(`/info.json?token=${token}`), 200);
  program.kill('SIGTERM');
  assert.equal(await program.ended, 0);
});
