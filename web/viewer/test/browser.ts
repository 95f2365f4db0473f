// Chromium for the tests of the page, and what they look at.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { inflateSync } from 'node:zlib';
import { chromium } from 'playwright-core';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';

declare const WEB: string; // by tools/test.mjs

export const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
export const SKIP = existsSync(CHROMIUM) ? false : `no ${CHROMIUM}`;

const FLAGS = ['--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];

export function launch(flags: string[] = []): Promise<Browser> {
  return chromium.launch({ executablePath: CHROMIUM, args: [...(process.getuid?.() === 0 ? ['--no-sandbox'] : []), ...FLAGS, ...flags] });
}

export interface Opened { page: Page; problems: string[]; requests: string[] }

// `problems`: what the console and the page complain of.
export async function open(browser: Browser, address: string, options: BrowserContextOptions = {}, before?: (page: Page) => Promise<void>): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const problems: string[] = [];
  const requests: string[] = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !/GL Driver Message/.test(message.text())) problems.push(message.text());
  });
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('request', (request) => requests.push(request.url()));
  await before?.(page);
  await page.goto(address);
  return { page, problems, requests };
}

export const count = async (page: Page, name: string) => Number(await page.textContent(`[data-count=${name}]`));
export const frames = (page: Page, least: number) =>
  page.waitForFunction((n) => Number(document.querySelector('[data-count=frames]')!.textContent) >= n, least, { timeout: 120e3 });

// What axe finds wrong with the page as it is now.
export async function violations(page: Page): Promise<string[]> {
  await page.evaluate(readFileSync(join(WEB, 'node_modules/axe-core/axe.min.js'), 'utf8'));
  return page.evaluate(async () => {
    const found = await (window as unknown as { axe: { run(): Promise<{ violations: { id: string; impact: string; nodes: { html: string; failureSummary: string }[] }[] }> } }).axe.run();
    return found.violations.map(({ id, impact, nodes }) => `${impact} ${id}: ${nodes.map((node) => node.html + node.failureSummary).join(' | ')}`);
  });
}

export interface Picture { width: number; height: number; at(x: number, y: number): [number, number, number] }

export async function screenshot(page: Page, clip?: { x: number; y: number; width: number; height: number }): Promise<Picture> {
  return decodePng(await page.screenshot({ clip }));
}

// Of the canvas alone, without what lies over it.
export async function sceneOnly(page: Page): Promise<Picture> {
  await page.evaluate(() => { for (const id of ['picture', 'panel', 'counts', 'status', 'transport', 'panel-toggle', 'notice']) document.getElementById(id)!.style.visibility = 'hidden'; });
  let last = '';
  let still: Buffer = Buffer.alloc(0);
  for (let i = 0; i < 60; ++i) { // until it stands still
    still = await page.screenshot();
    const now = still.toString('base64');
    if (now === last) break;
    last = now;
    await page.waitForTimeout(200);
  }
  await page.evaluate(() => { for (const id of ['picture', 'panel', 'counts', 'status', 'transport', 'panel-toggle', 'notice']) document.getElementById(id)!.style.visibility = ''; });
  return decodePng(still);
}

export function differing(a: Picture, b: Picture): number {
  let count = 0;
  for (let y = 0; y < a.height; ++y) {
    for (let x = 0; x < a.width; ++x) {
      const [p, q] = [a.at(x, y), b.at(x, y)];
      if (Math.abs(p[0] - q[0]) + Math.abs(p[1] - q[1]) + Math.abs(p[2] - q[2]) > 12) ++count;
    }
  }
  return count;
}

// 8 bits RGB or RGBA, as Chromium writes them.
function decodePng(file: Buffer): Picture {
  let at = 8;
  const data: Buffer[] = [];
  let [width, height, channels] = [0, 0, 0];
  while (at < file.length) {
    const length = file.readUInt32BE(at);
    const type = file.toString('latin1', at + 4, at + 8);
    const body = file.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR') [width, height, channels] = [body.readUInt32BE(0), body.readUInt32BE(4), body[9] === 6 ? 4 : 3];
    if (type === 'IDAT') data.push(body);
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(data));
  const stride = width * channels;
  const pixels = Buffer.alloc(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const left = x >= channels ? pixels[y * stride + x - channels] : 0;
      const up = y > 0 ? pixels[(y - 1) * stride + x] : 0;
      const corner = x >= channels && y > 0 ? pixels[(y - 1) * stride + x - channels] : 0;
      const p = left + up - corner;
      const [a, b, c] = [Math.abs(p - left), Math.abs(p - up), Math.abs(p - corner)];
      const paeth = a <= b && a <= c ? left : b <= c ? up : corner;
      const add = [0, left, up, (left + up) >> 1, paeth][filter];
      pixels[y * stride + x] = raw[y * (stride + 1) + 1 + x] + add;
    }
  }
  return {
    width, height,
    at: (x, y) => {
      const i = y * stride + x * channels;
      return [pixels[i], pixels[i + 1], pixels[i + 2]];
    },
  };
}
