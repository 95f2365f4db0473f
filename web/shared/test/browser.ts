// Starts Chromium for the tests of the page, and inspects the page.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { chromium } from 'playwright-core';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { readPng } from '../../scene/test/png.ts';

declare const WEB: string; // defined by tools/test.mjs

export const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
export const SKIP = existsSync(CHROMIUM) ? false : `no ${CHROMIUM}`;

const FLAGS = ['--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];

export function launch(flags: string[] = []): Promise<Browser> {
  return chromium.launch({ executablePath: CHROMIUM, args: [...(process.getuid?.() === 0 ? ['--no-sandbox'] : []), ...FLAGS, ...flags] });
}

export interface Opened { page: Page; problems: string[]; requests: string[] }

// Warnings that do not concern the page: the renderer's about its own speed, and about a late camera image on a busy
// machine.
const OF_THE_MACHINE = /GL Driver Message|the time jumps ahead/;

// `problems`: errors and warnings of the console and the page.
export async function open(browser: Browser, address: string, options: BrowserContextOptions = {}, before?: (page: Page) => Promise<void>): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const problems: string[] = [];
  const requests: string[] = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !OF_THE_MACHINE.test(message.text())) problems.push(message.text());
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

// Violations that axe finds in the current page.
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

// Screenshot of the canvas without the elements above it.
export async function sceneOnly(page: Page): Promise<Picture> {
  await page.evaluate(() => { for (const id of ['picture', 'panel', 'counts', 'status', 'transport', 'panel-toggle', 'notice', 'scale']) document.getElementById(id)!.style.visibility = 'hidden'; });
  let last = '';
  let still: Buffer = Buffer.alloc(0);
  for (let i = 0; i < 60; ++i) { // until it no longer changes
    still = await page.screenshot();
    const now = still.toString('base64');
    if (now === last) break;
    last = now;
    await page.waitForTimeout(200);
  }
  await page.evaluate(() => { for (const id of ['picture', 'panel', 'counts', 'status', 'transport', 'panel-toggle', 'notice', 'scale']) document.getElementById(id)!.style.visibility = ''; });
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
  const { width, height, channels, samples } = readPng(file);
  return {
    width, height,
    at: (x, y) => {
      const i = channels * (y * width + x);
      return [samples[i]!, samples[i + 1]!, samples[i + 2]!];
    },
  };
}
