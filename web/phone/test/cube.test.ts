// Tests the cube in Node: on a rendered recording it stays at the true position, given true depth and poses.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { test } from 'node:test';
import type { Pose } from '../../scene/src/messages.ts';
import { decode } from '../../scene/src/decode.ts';
import { inverse, transform } from '../../scene/src/pose.ts';
import { State } from '../../scene/src/state.ts';
import { readPng } from '../../scene/test/png.ts';
import type { Slam as SlamType } from '../../core/src/index.ts';
import { Cube } from '../src/cube.ts';
import { project, unproject } from '../src/lens.ts';
import type { Point } from '../src/lens.ts';

declare const WEB: string;

const program = process.env.ALIDADE_BINARY ?? join(WEB, '../build/bin/alidade');
const dist = join(WEB, 'core/dist');
const lacks = !existsSync(join(dist, 'single/alidade.wasm')) ? 'scripts/wasm/build has not been run' : !existsSync(program) ? `no ${program}` : false;

const median = (values: number[]) => [...values].sort((a, b) => a - b)[values.length >> 1]!;

test('pixels and rays of a lens with distortion are each other\'s inverse', () => {
  const camera = { width: 640, height: 480, fx: 500, fy: 510, cx: 310, cy: 250, distortion: [-0.28, 0.07, 1e-3, -5e-4, 0.01], baseline: 0 };
  for (const pixel of [[320, 240], [5, 8], [630, 470], [100, 400]] as const) {
    const back = project(camera, unproject(camera, pixel))!;
    assert.ok(Math.hypot(back[0] - pixel[0], back[1] - pixel[1]) < 1e-3, `${pixel} → ${back}`);
  }
  assert.equal(project(camera, [0, 0, -1]), null);
});

for (const [scene, seed] of [['room', 1], ['desk', 2]] as const) {
  test(`what is put on a surface stays there: ${scene}`, { skip: lacks, timeout: 300e3 }, async () => {
    const folder = mkdtempSync(join(tmpdir(), 'alidade-cube-'));
    execFileSync(program, ['synth', scene, folder, '--frames', '300', '--width', '400', '--height', '300', '--seed', String(seed), '--quiet']);
    const table = (name: string) => readFileSync(join(folder, name), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(' '));
    const [pictures, depths] = [table('rgb.txt'), table('depth.txt')];
    const truth: Pose[] = table('groundtruth.txt').map((line) => [4, 5, 6, 7, 1, 2, 3].map((i) => Number(line[i])));
    const { Slam } = await import(pathToFileURL(join(dist, 'index.js')).href) as { Slam: typeof SlamType };
    const focal = Number(/fx: ([\d.]+)/.exec(readFileSync(join(folder, 'camera.yaml'), 'utf8'))![1]);
    const slam = await Slam.create({ width: 400, height: 300, camera: { fx: focal, fy: focal, cx: 199.5, cy: 149.5 }, wasmBinary: readFileSync(join(dist, 'single/alidade.wasm')) });
    const state = new State();
    for (const bytes of slam.messages()) state.apply(decode(bytes)); // hello
    const cubes: { cube: Cube; tap: Point; p: [number, number, number]; off: number[] }[] = [];
    let tried = 0;
    for (let i = 0; i < pictures.length; ++i) {
      const { samples, channels } = readPng(readFileSync(join(folder, pictures[i]![1]!)));
      const frame = slam.track(Number(pictures[i]![0]), Uint8Array.from({ length: 400 * 300 }, (_, k) => (channels === 1 ? samples[k]! : (299 * samples[3 * k]! + 587 * samples[3 * k + 1]! + 114 * samples[3 * k + 2]!) / 1000)));
      for (const bytes of slam.messages()) {
        const message = decode(bytes);
        for (const { cube } of cubes) cube.follow(message);
        state.apply(message);
      }
      const pose = state.cameraPose();
      if (frame.state !== 'tracking' || !pose) continue;
      const camera = state.hello!.camera!;
      for (const { cube, p, off } of cubes) {
        const seen = project(camera, transform(inverse(truth[i]!), 1, ...p));
        const at = cube.position(state);
        if (!seen || seen[0] < 0 || seen[1] < 0 || seen[0] > 399 || seen[1] > 299 || !at) continue;
        const drawn = project(camera, transform(inverse(pose), 1, ...at));
        off.push(drawn ? Math.hypot(drawn[0] - seen[0], drawn[1] - seen[1]) : 400);
      }
      if (frame.counts.keyframes < 8 || tried > 0) continue;
      const depth = readPng(readFileSync(join(folder, depths[i]![1]!))).samples;
      for (const x of [80, 140, 200, 260, 320]) {
        for (const y of [90, 150, 210]) {
          ++tried;
          const z = depth[400 * y + x]! / 5000;
          const cube = Cube.place(state, [x, y]);
          if (!cube || z === 0) continue;
          const [u, v] = unproject(camera, [x, y]);
          cubes.push({ cube, tap: [x, y], p: transform(truth[i]!, 1, u * z, v * z, z), off: [] });
          // The cube is drawn at the tap.
          const drawn = project(camera, transform(inverse(pose), 1, ...cube.position(state)!))!;
          assert.ok(Math.hypot(drawn[0] - x, drawn[1] - y) < 0.5);
          assert.ok(cube.faces(state, pose).length === 6);
          // Twice the edge in map units is twice the size in the image, but for the perspective of its depth.
          const across = (edge: number) => Math.hypot(...[0, 1].map((k) => cube.faces(state, pose, edge)[0]!.corners[0]![k]! - cube.faces(state, pose, edge)[0]!.corners[2]![k]!));
          assert.ok(Math.abs(across(2e-3) / across(1e-3) - 2) < 0.05);
        }
      }
    }
    const medians = cubes.filter(({ off }) => off.length > 20).map(({ off }) => median(off));
    console.log(`${scene}: ${cubes.length} of ${tried} taps hit; median distance from the true place ${median(cubes.flatMap(({ off }) => off)).toFixed(1)} px, of each ${medians.map((m) => m.toFixed(1)).join(' ')}`);
    assert.ok(cubes.length >= 0.4 * tried && medians.length >= 5);
    assert.ok(median(cubes.flatMap(({ off }) => off)) <= 5);
    slam.delete();
    rmSync(folder, { recursive: true });
  });
}
