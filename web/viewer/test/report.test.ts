// report.html and compare.html opened as files, on a screen and on a phone, in light and dark, with and without
// scripts.
import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import { after, before, test } from 'node:test';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { differing, launch, open, screenshot, violations } from '../../shared/test/browser.ts';
import { endAll, inFolder, NO_PROGRAM, run } from '../../shared/test/program.ts';

const options = { skip: NO_PROGRAM, timeout: 600e3 };
const PHONE = { viewport: { width: 400, height: 800 } };
const PAGES = ['room/report.html', 'shape/report.html', 'compare.html', 'many.html'];
const MANY = 7; // runs of many.html, more than fit into one table

let browser: Browser;
const address = (name: string) => `file://${inFolder(name)}`;

before(async () => {
  if (NO_PROGRAM) return;
  browser = await launch();
  await run('run', 'synth:room?frames=60', '--quiet', '--out', inFolder('room'));
  await run('run', 'synth:desk?frames=60', '--sensor', 'rgbd', '--semidense', '--quiet', '--out', inFolder('shape'));
  await run('compare', inFolder('room'), inFolder('shape'), '--out', inFolder('compare.html'));
  const copies = Array.from({ length: MANY }, (_, i) => inFolder(`a_run_with_a_long_name_${i}`));
  for (const copy of copies) cpSync(inFolder('room'), copy, { recursive: true });
  await run('compare', ...copies, '--out', inFolder('many.html'));
});
after(async () => {
  await browser?.close();
  await endAll();
});

const LOOKS: [string, BrowserContextOptions][] = [
  ['light', { colorScheme: 'light' }], ['dark', { colorScheme: 'dark' }],
  ['on a phone', { ...PHONE, colorScheme: 'light' }], ['on a phone, dark', { ...PHONE, colorScheme: 'dark' }],
];
for (const name of PAGES) {
  for (const [look, settings] of LOOKS) {
    test(`${name}, ${look}: nothing is complained of, asked for or cut off`, options, async () => {
      const { page, problems, requests } = await open(browser, address(name), settings);
      await page.waitForTimeout(300);
      const wide = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
      assert.ok(wide[0] <= wide[1], `${wide[0]} pixels wide on ${wide[1]}`);
      if (name === 'many.html') {
        const tables = await page.evaluate(() => [...document.querySelectorAll('.wide')].map(({ scrollWidth, clientWidth }) => scrollWidth - clientWidth));
        assert.deepEqual(tables, [0, 0], 'columns are cut off');
      }
      assert.deepEqual(await violations(page), []);
      assert.deepEqual(problems, []);
      assert.deepEqual(requests.filter((url) => url !== address(name) && !url.startsWith('data:')), []);
      await page.context().close();
    });
  }
}

async function canvas(page: Page) {
  await page.locator('#turn canvas').scrollIntoViewIfNeeded();
  await page.waitForTimeout(300);
  const box = (await page.locator('#turn canvas').boundingBox())!;
  return screenshot(page, { x: Math.ceil(box.x) + 2, y: Math.ceil(box.y) + 2, width: Math.floor(box.width) - 4, height: Math.floor(box.height) - 4 });
}

for (const name of PAGES.slice(0, 2)) {
  test(`${name}: the cloud turns with the keys, the mouse and the buttons`, options, async () => {
    const { page, problems } = await open(browser, address(name));
    assert.equal(await page.isVisible('#turn img'), false);
    const first = await canvas(page);
    let drawn = 0;
    for (let y = 0; y < first.height; y += 2) {
      for (let x = 0; x < first.width; x += 2) {
        if (first.at(x, y).some((part, i) => Math.abs(part - first.at(0, 0)[i]) > 12)) ++drawn;
      }
    }
    assert.ok(drawn > 500, `${drawn} pixels drawn`);
    await page.focus('#turn canvas');
    await page.keyboard.press('ArrowLeft');
    const turned = await canvas(page);
    assert.ok(differing(first, turned) > 500);
    const box = (await page.locator('#turn canvas').boundingBox())!;
    await page.mouse.move(box.x + 200, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 260, box.y + 130);
    await page.mouse.up();
    assert.ok(differing(turned, await canvas(page)) > 500);
    await page.click('#turn button[data-view=behind]');
    await page.locator('#turn canvas').blur();
    assert.ok(differing(first, await canvas(page)) < 200); // back at the initial view
    assert.deepEqual(problems, []);
    await page.context().close();
  });

  test(`${name}: without scripts, or without WebGL, there is a picture`, options, async () => {
    const still = await open(browser, address(name), { javaScriptEnabled: false });
    assert.equal(await still.page.locator('#turn img').isVisible(), true);
    assert.equal(await still.page.locator('#turn canvas').isVisible(), false);
    assert.equal(await still.page.locator('#turn button').first().isVisible(), false);
    await still.page.context().close();
    const flat = await open(browser, address(name), {}, async (page) => {
      await page.addInitScript(() => { HTMLCanvasElement.prototype.getContext = () => null; });
    });
    assert.equal(await flat.page.isVisible('#turn img'), true);
    assert.equal(await flat.page.isVisible('#turn canvas'), false);
    assert.deepEqual(flat.problems, []);
    await flat.page.context().close();
  });
}

test('keyframes are shown with their features and depth, and what was measured', options, async () => {
  const { page } = await open(browser, address('shape/report.html'));
  const pictures = await page.evaluate(() => [...document.querySelectorAll<HTMLImageElement>('.keyframes-shown img')].map((image) => image.complete && image.naturalWidth));
  assert.ok(pictures.length >= 4 && pictures.length <= 16, `${pictures.length} pictures`);
  assert.deepEqual(pictures.filter((width) => width !== 320), []);
  assert.match((await page.textContent('.keyframes-shown'))!, /features; semi-dense depth, [\d.]+ to [\d.]+ m/);
  assert.ok(await page.locator('svg[aria-label^=histogram]').count() >= 4);
  assert.ok(await page.locator('svg[aria-label="distance to the ground truth over time"]').isVisible());
  await page.context().close();
});
