// Run by `alidade-bench phone` as node bench.mjs FOLDER. Reads job.json and frames.gray (consecutive images, one byte
// per pixel) in the folder, and writes result.json: milliseconds per stage from the stream, and the trajectory.
import { closeSync, openSync, readFileSync, readSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { decode } from '../../scene/src/decode.ts';
import { Slam, type Calibration } from '../src/index.ts';

interface Job { width: number; height: number; times: number[]; camera: Calibration; settings: Record<string, string> }

const folder = process.argv[2]!;
const job = JSON.parse(readFileSync(join(folder, 'job.json'), 'utf8')) as Job;
const single = fileURLToPath(new URL('../single/bin/', import.meta.url)); // build-wasm/single/bin
const slam = await Slam.create({
  width: job.width, height: job.height, camera: job.camera, settings: job.settings,
  base: pathToFileURL(single).href, wasmBinary: readFileSync(join(single, 'alidade.wasm')),
});
const STAGES = ['frame', 'extract', 'track', 'map'] as const; // names and order of Frame.ms
const stages: Record<(typeof STAGES)[number], number[]> = { frame: [], extract: [], track: [], map: [] };
const picture = new Uint8Array(job.width * job.height);
const frames = openSync(join(folder, 'frames.gray'), 'r');
let keyframes = 0;
slam.messages(); // hello
const before = process.cpuUsage();
for (const time of job.times) {
  if (readSync(frames, picture) !== picture.length) throw new Error('frames.gray is too short');
  keyframes = slam.track(time, picture).counts.keyframes;
  for (const bytes of slam.messages()) {
    const message = decode(bytes);
    if (message.kind !== 'frame') continue;
    STAGES.forEach((name, i) => { if ((message.ms[i] ?? -1) >= 0) stages[name].push(message.ms[i]!); });
  }
}
const { user, system } = process.cpuUsage(before);
closeSync(frames);
slam.finish();
writeFileSync(join(folder, 'result.json'), JSON.stringify({ ...stages, cpu: (user + system) / 1e3 / job.times.length, keyframes, trajectory: slam.trajectory() }));
slam.delete();
