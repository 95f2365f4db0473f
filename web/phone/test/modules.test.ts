// The threaded module with the inline schedule and one thread gives the same bytes as the single-threaded one. Runs in
// a browser, because the threaded module is built for one.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { launch, open, SKIP } from '../../shared/test/browser.ts';
import { BINARY, NO_PROGRAM } from '../../shared/test/program.ts';
import { startSite } from './server.ts';
import { grayOf, openRecording } from '../../shared/test/y4m.ts';

declare const WEB: string;

const built = ['single', 'threads'].every((name) => existsSync(join(WEB, 'core/dist', name, 'alidade.wasm')));
const FRAMES = 120;

// Source of a Worker that gets a module's name and replies with hashes of the results.
const WORKER = `
import { Slam } from './core/index.js';
const hash = async (bytes) => Array.from(new Uint8Array(await crypto.subtle.digest('SHA-256', bytes)), (byte) => byte.toString(16).padStart(2, '0')).join('');
onmessage = async ({ data: { module, width, height, frames, fov } }) => {
  const pictures = new Uint8Array(await (await fetch('./frames.gray')).arrayBuffer());
  const slam = await Slam.create({ width, height, fov, threads: 1, base: new URL('./core/' + module + '/', location.href).href });
  const milliseconds = [];
  let tracked = 0;
  for (let i = 0; i < frames; ++i) {
    const frame = slam.track(i / 30, pictures.subarray(i * width * height, (i + 1) * width * height));
    milliseconds.push(frame.milliseconds);
    tracked += frame.pose ? 1 : 0;
  }
  slam.finish();
  postMessage({ tracked, trajectory: await hash(new TextEncoder().encode(slam.trajectory())), map: await hash(slam.map()),
    median: milliseconds.sort((a, b) => a - b)[frames >> 1] });
};`;

interface Outcome { tracked: number; trajectory: string; map: string; median: number }

test('the module with threads gives the same bytes as the one without', { skip: SKIP || NO_PROGRAM || (built ? false : 'scripts/wasm/build has not built both modules'), timeout: 300e3 }, async () => {
  const folder = mkdtempSync(join(tmpdir(), 'alidade-modules-'));
  const kitchen = join(process.env.ALIDADE_DATA ?? '', 'kitchen');
  let source = join(folder, 'room');
  if (process.env.ALIDADE_DATA && existsSync(kitchen)) source = kitchen;
  else execFileSync(BINARY, ['synth', 'room', source, '--frames', String(FRAMES), '--quiet']);
  const recording = openRecording(source);
  const pictures = Array.from({ length: FRAMES }, (_, i) => grayOf(recording, i));
  writeFileSync(join(folder, 'frames.gray'), Buffer.concat(pictures));
  writeFileSync(join(folder, 'run.js'), WORKER);
  const site = await startSite(true, { 'frames.gray': join(folder, 'frames.gray'), 'run.js': join(folder, 'run.js') });
  const browser = await launch();
  try {
    const { page } = await open(browser, site.address);
    const run = (module: string) => page.evaluate((job) => new Promise<Outcome>((resolve, reject) => {
      const worker = new Worker('./run.js', { type: 'module' });
      worker.onmessage = ({ data }) => { worker.terminate(); resolve(data as Outcome); };
      worker.onerror = (event) => reject(new Error(event.message));
      worker.postMessage(job);
    }), { module, width: recording.width, height: recording.height, frames: FRAMES, fov: 62.5 });
    const single = await run('single');
    const threads = await run('threads');
    console.log(`${FRAMES} pictures: ${single.tracked} tracked; median ${single.median.toFixed(1)} ms without threads, ${threads.median.toFixed(1)} ms with the other module on one`);
    assert.ok(single.tracked > 0.6 * FRAMES, String(single.tracked));
    assert.equal(threads.trajectory, single.trajectory);
    assert.equal(threads.map, single.map);
  } finally {
    await browser.close();
    await site.close();
    rmSync(folder, { recursive: true, force: true });
  }
});
