// `alidade view` of a result without a recording: what lies in its folder is shown, nothing that is empty; lengths are
// measured; the image is saved.
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import type { Pose, Scene, State } from '@alidade/scene';
import { compose } from '../../scene/src/pose.ts';
import { readPng } from '../../scene/test/png.ts';
import { count, launch, open, violations } from '../../shared/test/browser.ts';
import { endAll, inFolder, NO_PROGRAM, run, start, table } from '../../shared/test/program.ts';
import type { Ruler } from '../src/ruler.ts';

const options = { skip: NO_PROGRAM, timeout: 600e3 };

interface Viewer { state: State; scene: Scene; ruler: Ruler; project(p: readonly number[]): { x: number; y: number } | null }

let browser: Browser;
let folder = '';

before(async () => {
  if (NO_PROGRAM) return;
  browser = await launch();
  folder = inFolder('still');
  await run('run', 'synth:room?frames=100', '--sensor', 'mono', '--semidense', '--quiet', '--out', folder);
});
after(async () => {
  await browser?.close();
  await endAll();
});

const shown = async (page: Page) => {
  await page.waitForFunction(() => Number(document.querySelector('[data-count=landmarks]')!.textContent) > 0);
  await page.waitForFunction(() => !document.querySelector<HTMLElement>('[data-layer=cloud]')!.closest('label')!.hidden, undefined, { timeout: 60e3 });
};

for (const size of [{ width: 1280, height: 800 }, { width: 412, height: 915 }]) {
  test(`map, path and depth of the folder, and nothing empty: ${size.width} pixels wide`, options, async () => {
    const program = await start('view', folder, '--port', '0');
    const { page, problems } = await open(browser, program.address, { viewport: size });
    await shown(page);
    const path = await page.evaluate(() => {
      const { state } = (window as unknown as { alidade: Viewer }).alidade;
      return Array.from({ length: state.path.length }, (_, i) => {
        const { time, reference, T_reference_camera } = state.path.at(i);
        const { T_world_camera, scale } = state.keyframes.get(reference)!;
        return { time, scale, T_world_camera, T_reference_camera };
      });
    });
    const trajectory = table(join(folder, 'trajectory.txt'));
    assert.equal(path.length, trajectory.length);
    path.forEach(({ time, scale, T_world_camera, T_reference_camera }, i) => {
      const T = compose(T_world_camera as Pose, scale, T_reference_camera as Pose);
      const [at, x, y, z] = trajectory[i]! as [number, number, number, number];
      assert.ok(Math.abs(time - at) < 1e-6 && Math.hypot(T[4] - x, T[5] - y, T[6] - z) < 1e-5, `frame ${i}: ${T.slice(4).join(' ')} is not ${x} ${y} ${z}`);
    });
    assert.equal(await count(page, 'frames'), trajectory.length);
    assert.match((await page.textContent('#still-note'))!, /the map, the path and depth\..*--record/);
    for (const selector of ['#picture', '#transport', '#plot', '#events', '[data-count=matches]', '[data-layer=truth]', '[data-layer=camera]']) {
      assert.equal(await page.isVisible(selector), false, selector);
    }
    assert.deepEqual((await violations(page)).filter((text) => /^(serious|critical)/.test(text)), []);
    assert.deepEqual(problems, []);
    await page.context().close();
    program.kill('SIGINT');
  });
}

test('the distance between two points that are clicked, and the image with its scale bar', options, async () => {
  const program = await start('view', folder, '--port', '0');
  const { page, problems } = await open(browser, program.address);
  await shown(page);
  await page.uncheck('[data-layer=cloud]');
  await page.waitForTimeout(1500); // the view moves to the whole map
  // Landmarks in sight with no other one near them in the image.
  const points = await page.evaluate(() => {
    const { state, project } = (window as unknown as { alidade: Viewer }).alidade;
    const all = Array.from({ length: state.landmarks.size }, (_, i) => state.landmarks.at(i)).map(({ keyframe, p }) => {
      const { T_world_camera: [qx, qy, qz, qw, ...t], scale } = state.keyframes.get(keyframe)!;
      const [x, y, z] = p.map((value) => scale * value) as [number, number, number];
      const c = [2 * (qy * z - qz * y), 2 * (qz * x - qx * z), 2 * (qx * y - qy * x)] as const;
      const world = [x + qw * c[0] + qy * c[2] - qz * c[1] + t[0], y + qw * c[1] + qz * c[0] - qx * c[2] + t[1], z + qw * c[2] + qx * c[1] - qy * c[0] + t[2]];
      return { world, at: project(world)! };
    }).filter(({ at }) => at);
    const alone = all.filter(({ at }) => document.elementFromPoint(at.x, at.y)?.id === 'scene' && all.every(({ at: other }) => other === at || Math.hypot(other.x - at.x, other.y - at.y) > 20));
    return [alone[0]!, alone.at(-1)!];
  });
  await page.click('#measure');
  for (const { at } of points) await page.mouse.click(at.x + 1, at.y);
  const [a, b] = points.map(({ world }) => world) as [number[], number[]];
  const expected = Math.hypot(...a.map((value, k) => value - b[k]!));
  const distance = (await page.evaluate(() => (window as unknown as { alidade: Viewer }).alidade.ruler.distance))!;
  assert.ok(Math.abs(distance - expected) < 1e-5 * expected, `${distance} is not ${expected}`);
  assert.match((await page.textContent('#measured'))!, new RegExp(`^${expected.toPrecision(3).replace('.', '\\.')} map units$`));
  // The bar is as long as it says, where the view looks at.
  const bar = (await page.locator('#scale-bar').boundingBox())!.width;
  const units = Number(/^([\d.]+) map unit/.exec((await page.textContent('#scale-text'))!)![1]);
  assert.ok(Math.abs(bar / units / await page.evaluate(() => (window as unknown as { alidade: Viewer }).alidade.scene.pixelsPerUnit) - 1) < 0.02);
  const saved = page.waitForEvent('download');
  await page.click('#snapshot');
  const download = await saved;
  assert.equal(download.suggestedFilename(), 'still.png');
  await download.saveAs(inFolder('saved.png'));
  const { width, height, samples } = readPng(readFileSync(inFolder('saved.png')));
  assert.deepEqual([width, height], [1280, 800]);
  assert.ok(new Set(samples).size > 20 && statSync(inFolder('saved.png')).size > 5000);
  await page.keyboard.press('m');
  assert.equal(await page.isVisible('#measured'), false);
  assert.deepEqual(problems, []);
  await page.context().close();
  program.kill('SIGINT');
});

test('a map alone says so', options, async () => {
  const program = await start('view', join(folder, 'map.alidade'), '--port', '0');
  const { page, problems } = await open(browser, program.address);
  await page.waitForFunction(() => Number(document.querySelector('[data-count=landmarks]')!.textContent) > 0);
  assert.match((await page.textContent('#still-note'))!, /there is the map\./);
  for (const layer of ['path', 'cloud']) assert.equal(await page.isVisible(`[data-layer=${layer}]`), false, layer);
  assert.equal(await page.isVisible('[data-count=frames]'), false);
  assert.deepEqual(problems, []);
  await page.context().close();
  program.kill('SIGINT');
});
