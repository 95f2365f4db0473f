// Uses the package as a Node program does, on rendered frames and, if ALIDADE_DATA is set, on a real recording.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { test } from 'node:test';
import { grayOf, openRecording } from '../../shared/test/y4m.ts';
import { decode } from '../../scene/src/decode.ts';
import { inverse, rotate } from '../../scene/src/pose.ts';
import { REASONS } from '../src/index.ts';
import type { Calibration, Pose, Slam as SlamType, SlamOptions } from '../src/index.ts';

declare const WEB: string;
const dist = join(WEB, 'core/dist');
const program = process.env.ALIDADE_BINARY ?? join(WEB, '../build/bin/alidade');
const built = existsSync(join(dist, 'single/alidade.wasm'));
const options = { skip: built ? false : 'scripts/wasm/build has not been run', timeout: 300e3 };
const { Slam } = (built ? await import(pathToFileURL(join(dist, 'index.js')).href) : {}) as { Slam: typeof SlamType };

const create = (more: Partial<SlamOptions> & { width: number; height: number }) =>
  Slam.create({ wasmBinary: readFileSync(join(dist, 'single/alidade.wasm')), ...more });

// ATE as evaluated by the program, meters.
function ate(folder: string, trajectory: string): { rmse: number; coverage: number } {
  const file = join(mkdtempSync(join(tmpdir(), 'alidade-')), 'trajectory.txt');
  writeFileSync(file, trajectory);
  return JSON.parse(execFileSync(program, ['evaluate', 'ate', join(folder, 'groundtruth.txt'), file, '--align', 'sim3', '--json'], { encoding: 'utf8' })) as { rmse: number; coverage: number };
}

const kitchen = join(process.env.ALIDADE_DATA ?? '', 'kitchen');
const onKitchen = { ...options, skip: options.skip || (process.env.ALIDADE_DATA && existsSync(kitchen) && existsSync(program) ? false : 'ALIDADE_DATA does not point to the recordings') };

function median(values: number[]): number { return [...values].sort((a, b) => a - b)[values.length >> 1]!; }

test('a real recording: as good as the native core', onKitchen, async () => {
  const recording = openRecording(kitchen);
  const camera = Object.fromEntries(readFileSync(join(kitchen, 'camera.yaml'), 'utf8').split('\n').map((line) => line.split(/:\s*/)).filter((pair) => pair.length === 2)) as Record<string, string>;
  const slam = await create({
    width: recording.width, height: recording.height,
    camera: { fx: Number(camera.fx), fy: Number(camera.fy), cx: Number(camera.cx), cy: Number(camera.cy) },
  });
  const milliseconds: number[] = [];
  let messages = slam.messages();
  assert.equal(messages.length, 1); // hello
  for (let i = 0; i < recording.times.length; ++i) {
    const frame = slam.track(recording.times[i]!, grayOf(recording, i));
    milliseconds.push(frame.milliseconds);
    assert.equal(frame.state === 'tracking', frame.reason === '');
    assert.equal(frame.state === 'tracking', frame.failure === null);
    messages = slam.messages();
    assert.ok(messages.length >= 1);
  }
  for (const message of messages) assert.ok(decode(message));
  assert.equal(slam.finish(), slam.trajectory());
  const out = mkdtempSync(join(tmpdir(), 'alidade-'));
  execFileSync(program, ['run', kitchen, '--sensor', 'mono', '--profile', 'phone', '--threads', '1', '--out', join(out, 'native'), '--quiet']);
  const native = JSON.parse(readFileSync(join(out, 'native/stats.json'), 'utf8')) as { tracked: number; ms: { frame: { median: number } } };
  const here = ate(kitchen, slam.trajectory());
  const there = ate(kitchen, readFileSync(join(out, 'native/trajectory.txt'), 'utf8'));
  const tracked = slam.trajectory().split('\n').filter((line) => line && !line.startsWith('#')).length;
  console.log(`kitchen: ${tracked} of ${recording.times.length} frames (native ${native.tracked}), ATE ${(100 * here.rmse).toFixed(2)} cm (native ${(100 * there.rmse).toFixed(2)}), `
    + `median ${median(milliseconds).toFixed(1)} ms (native ${native.ms.frame.median.toFixed(1)})`);
  assert.ok(tracked >= 0.95 * native.tracked);
  assert.ok(here.rmse < 1.05 * there.rmse + 0.001, `${here.rmse} against ${there.rmse}`);
  assert.ok(slam.map().length > 1e5);
  assert.match(new TextDecoder('latin1').decode(slam.cloud().slice(0, 40)), /^ply\nformat binary_little_endian/);
  slam.delete();
  assert.throws(() => slam.finish(), /deleted/);
  rmSync(out, { recursive: true });
});

test('a camera nobody calibrated is found on the way', onKitchen, async () => {
  const recording = openRecording(kitchen);
  const slam = await create({ width: recording.width, height: recording.height });
  let frame = slam.track(recording.times[0]!, grayOf(recording, 0));
  assert.ok(Math.abs(frame.fov - 66) < 0.1 && frame.fovSigma > 10);
  for (let i = 1; i < recording.times.length; ++i) frame = slam.track(recording.times[i]!, grayOf(recording, i));
  console.log(`kitchen, nothing known: ${frame.fov.toFixed(1)} ± ${frame.fovSigma.toFixed(1)} degrees (62.5), ${frame.cameraChanges} changes`);
  assert.ok(frame.fovSigma < 2 && Math.abs(frame.fov - 62.5) < 3 * frame.fovSigma);
  assert.equal(frame.state, 'tracking');
  slam.finish();
  assert.ok(ate(kitchen, slam.trajectory()).rmse < 0.08);
  slam.delete();
});

test('a detector that answers late: what it finds is left out', onKitchen, async () => {
  const recording = openRecording(kitchen);
  const slam = await create({ width: recording.width, height: recording.height, fov: 62.5, classes: ['person', 'dog'] });
  const box = { class: 0, score: 0.9, x: 160, y: 120, width: 320, height: 300 };
  for (let i = 0; i < 60; ++i) {
    const frame = slam.track(recording.times[i]!, grayOf(recording, i));
    assert.equal(frame.number, i);
    if (i >= 10 && i % 5 === 0) slam.detected(i - 10, [box]);
  }
  // Processed images are 400 pixels wide.
  const inside = slam.features().filter(({ x, y }) => Math.abs(x - 200) < 60 && Math.abs(y - 170) < 60);
  const matched = inside.filter((feature) => feature.matched).length;
  assert.ok(matched < 0.2 * slam.features().filter((feature) => feature.matched).length, `${matched} of ${slam.features().length}`);
  assert.throws(() => slam.detected(59, [{ ...box, class: 2 }]), /class 2 of 2/);
  slam.detected(59, []);
  slam.delete();
});

test('shape: what it costs a keyframe', onKitchen, async () => {
  const recording = openRecording(kitchen);
  const frames = 300;
  const pictures = Array.from({ length: frames }, (_, i) => grayOf(recording, i));
  const cost = async (semidense: boolean) => {
    const slam = await create({ width: recording.width, height: recording.height, fov: 62.5, settings: { 'semidense.enabled': semidense } });
    const before = process.cpuUsage();
    for (let i = 0; i < frames; ++i) slam.track(recording.times[i]!, pictures[i]!);
    const { user, system } = process.cpuUsage(before);
    const { keyframes } = slam.track(recording.times[frames - 1]! + 1 / 30, pictures[frames - 1]!).counts;
    slam.delete();
    return { milliseconds: (user + system) / 1000, keyframes };
  };
  await cost(true); // warm-up: Node recompiles hot code
  const [without, withShape] = [await cost(false), await cost(true)];
  console.log(`semi-dense depth: ${((withShape.milliseconds - without.milliseconds) / withShape.keyframes).toFixed(1)} ms of CPU a keyframe (${withShape.keyframes} of ${frames} frames, ${without.milliseconds.toFixed(0)} ms without, ${withShape.milliseconds.toFixed(0)} with)`);
  assert.equal(withShape.keyframes, without.keyframes); // the map is the same
});

test('readings of an inertial sensor: meters and gravity', { ...options, skip: options.skip || (existsSync(program) ? false : `no ${program}`) }, async () => {
  const folder = mkdtempSync(join(tmpdir(), 'alidade-imu-'));
  execFileSync(program, ['synth', 'desk', folder, '--frames', '180', '--width', '400', '--height', '300', '--seed', '2', '--imu', 'phone', '--quiet']);
  const rows = (name: string) => readFileSync(join(folder, name), 'utf8').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split(/[ ,]/).map(Number));
  const [readings, truth, recording] = [rows('imu.csv'), rows('groundtruth.txt'), openRecording(folder)];
  const camera = Object.fromEntries(['fx', 'fy', 'cx', 'cy'].map((name) => [name, Number(new RegExp(`${name}: ([\\d.]+)`).exec(readFileSync(join(folder, 'camera.yaml'), 'utf8'))![1])])) as unknown as Calibration;
  const slam = await create({ width: 400, height: 300, camera });
  assert.deepEqual([slam.inertial().samples, slam.inertial().metric, slam.inertial().gravity], [0, false, null]);
  assert.throws(() => slam.track(0, new Uint8Array(400 * 300), new Float64Array(8)), /7 numbers/);
  const placed: { p: Pose; i: number }[] = [];
  let next = 0;
  for (let i = 0; i < recording.times.length; ++i) {
    const imu: number[] = [];
    while (next < readings.length && readings[next]![0]! < recording.times[i]! + 1 / 60) imu.push(...readings[next++]!);
    const { pose } = slam.track(recording.times[i]!, grayOf(recording, i), Float64Array.from(imu));
    if (slam.inertial().metric && pose) placed.push({ p: pose, i });
  }
  const told = slam.inertial();
  assert.ok(told.metric && told.missing === '' && told.leftOut === '', `${told.missing} ${told.leftOut}`);
  assert.ok(told.scaleSigma > 0 && told.scaleSigma < 0.05 && placed.length > 20);
  // Between the poses since, the way straight from the first to the last.
  const [first, last] = [placed[0]!, placed.at(-1)!];
  const long = (a: readonly number[], b: readonly number[]) => Math.hypot(a[0]! - b[0]!, a[1]! - b[1]!, a[2]! - b[2]!);
  const ratio = long(first.p.position, last.p.position) / long(truth[first.i]!.slice(1, 4), truth[last.i]!.slice(1, 4));
  // Gravity in the last camera's frame; things fall along -z in the rendered world.
  const [q, T] = [last.p.orientation, truth[last.i]!.slice(4, 8)];
  const here = rotate(inverse([...q, 0, 0, 0]), ...told.gravity!);
  const there = rotate(inverse([...T, 0, 0, 0]), 0, 0, -1);
  const tilt = Math.acos(here[0] * there[0] + here[1] * there[1] + here[2] * there[2]);
  console.log(`lengths x ${ratio.toFixed(3)} ± ${told.scaleSigma.toFixed(3)}, gravity ${((tilt * 180) / Math.PI).toFixed(2)}° off, clock ${(1000 * told.timeOffset).toFixed(1)} ms`);
  assert.ok(Math.abs(ratio - 1) < 3 * told.scaleSigma, `${ratio}`);
  assert.ok(tilt < 0.02 && told.gravitySigma < 0.035, `${tilt}`); // 1 degree
  slam.delete();
  rmSync(folder, { recursive: true });
});

test('what cannot be is refused in words, and nothing is lost', options, async () => {
  await assert.rejects(create({ width: 0, height: 10 }), /0x10/);
  await assert.rejects(create({ width: 64, height: 48, fov: 200 }), /field of view/);
  await assert.rejects(create({ width: 64, height: 48, settings: { 'tracker.no_such': 1 } }), /no_such/);
  const slam = await create({ width: 64, height: 48 });
  assert.throws(() => slam.track(0, new Uint8Array(10)), /10 bytes/);
  assert.throws(() => slam.track(NaN, new Uint8Array(64 * 48)), /time/);
  const frame = slam.track(1, new Uint8Array(64 * 48));
  assert.equal(frame.state, 'initializing');
  assert.equal(frame.pose, null);
  assert.equal(frame.failure, 'few_corners');
  assert.equal(frame.reason, REASONS.few_corners);
  assert.deepEqual(slam.features(), []);
  slam.delete();
  slam.delete();
});

test('the order of version 0.1, image then time, is accepted with one warning', options, async (context) => {
  const warn = context.mock.method(console, 'warn', () => undefined);
  const slam = await create({ width: 64, height: 48 });
  assert.equal(slam.track(new Uint8Array(64 * 48), 1).number, 0);
  assert.equal(slam.track(new Uint8Array(64 * 48), 2).number, 1);
  assert.equal(slam.track(3, new Uint8Array(64 * 48)).number, 2);
  assert.equal(slam.finish(), slam.trajectory());
  assert.equal(warn.mock.callCount(), 1);
  assert.match(String(warn.mock.calls[0]!.arguments[0]), /track\(time, picture\)/);
  slam.delete();
});

test('a core that was loaded in advance serves one session', options, async () => {
  const wasmBinary = readFileSync(join(dist, 'single/alidade.wasm'));
  await Slam.prepare({ wasmBinary });
  const size = { width: 64, height: 48 };
  const first = await Slam.create(size); // without wasmBinary, it could not be loaded in Node
  const second = await create(size);
  assert.equal(first.track(0, new Uint8Array(64 * 48)).number, 0);
  first.delete();
  assert.equal(second.track(0, new Uint8Array(64 * 48)).number, 0);
  second.delete();
});

test('many sessions on end leave no memory behind', options, async () => {
  const picture = new Uint8Array(320 * 240).map((_, i) => (i * 2654435761) >>> 24);
  for (let i = 0; i < 40; ++i) {
    const slam = await create({ width: 320, height: 240 });
    for (let k = 0; k < 3; ++k) slam.track(k / 30, picture);
    slam.delete();
  }
  assert.ok(process.memoryUsage().rss < 1.5e9);
});

test('the package holds what it needs and no more', options, () => {
  const files = readdirSync(dist).sort();
  for (const name of ['index.d.ts', 'index.js', 'single']) assert.ok(files.includes(name), files.join());
  const bytes = readFileSync(join(dist, 'single/alidade.wasm')).length;
  assert.ok(bytes <= 4e6, `${bytes} bytes`);
});
