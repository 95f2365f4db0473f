// Reads the program's MCAP files with third-party readers and compares them with the run's result files, field by
// field.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { parse } from '@foxglove/rosmsg';
import { ros2humble } from '@foxglove/rosmsg-msgs-common';
import jpeg from 'jpeg-js';
import { BINARY, NO_BINARY, run, table } from '../../scene/test/binary.ts';
import { points, readIndexed, readThrough, row, seconds } from './read.ts';

const options = { skip: NO_BINARY, timeout: 300e3 };
const DATA = process.env.ALIDADE_DATA;
const folder = mkdtempSync(join(tmpdir(), 'alidade-mcap-'));
const at = (name: string) => join(folder, name);
const ROOM = ['synth:room?frames=60&width=320&height=240', '--sensor', 'rgbd', '--semidense', '--quiet'];
// trajectory.txt has 9 decimals; a double holds 7 decimals of a time at most.
const POSE = 1e-8;
const TIME = 1e-6;

type File = Awaited<ReturnType<typeof readIndexed>>;
let recorded: File;

before(async () => {
  if (NO_BINARY) return;
  await run('run', ...ROOM, '--record-to', at('run.mcap'), '--out', at('results'));
  recorded = await readIndexed(at('run.mcap'));
});
after(() => rmSync(folder, { recursive: true, force: true }));

function assertRows(found: number[][], expected: number[][]): void {
  assert.equal(found.length, expected.length);
  found.forEach((pose, i) => {
    assert.ok(Math.abs(pose[0] - expected[i][0]) < TIME, `${pose[0]} is not ${expected[i][0]}`);
    // Q and -q are the same rotation.
    const sign = Math.sign(pose.slice(4).reduce((sum, value, k) => sum + value * expected[i][4 + k], 0));
    pose.slice(1).forEach((value, k) => assert.ok(Math.abs((k < 3 ? value : sign * value) - expected[i][1 + k]) < POSE, `pose ${i}: ${pose} is not ${expected[i]}`));
  });
}

const cameras = (file: File) => file.on('/tf').flatMap(({ message }) => message.transforms).filter((each) => each.child_frame_id === 'camera_optical');
const poseRows = (file: File) => file.on('/alidade/pose').map(({ message: { header, pose } }) => row(header.stamp, pose.position, pose.orientation));
const tfRows = (transforms: any[]) => transforms.map(({ header, transform }) => row(header.stamp, transform.translation, transform.rotation));
const stats = (results: string) => JSON.parse(readFileSync(join(results, 'stats.json'), 'utf8'));
const vertices = (path: string) => Number(/element vertex (\d+)/.exec(readFileSync(path, 'latin1').slice(0, 1000))![1]);

// The last messages of the file equal the results.
function assertEnd(file: File, results: string): void {
  const trajectory = table(join(results, 'trajectory.txt'));
  const path = file.on('/alidade/path').at(-1)!.message;
  assertRows(path.poses.map(({ header, pose }: any) => row(header.stamp, pose.position, pose.orientation)), trajectory);
  const [, ...last] = tfRows([cameras(file).at(-1)])[0];
  assertRows([[0, ...last]], [[0, ...trajectory.at(-1)!.slice(1)]]);
  const landmarks = points(file.on('/alidade/landmarks').at(-1)!.message);
  assert.deepEqual(landmarks, table(join(results, 'landmarks.ply')).map((point) => point.map(Math.fround)));
  assert.ok(landmarks.length > 100);
  const shape = join(results, 'semidense.ply');
  if (!existsSync(shape)) return assert.equal(file.on('/alidade/semidense').length, 0);
  const cloud = points(file.on('/alidade/semidense').at(-1)!.message);
  assert.equal(cloud.length, vertices(shape));
  const ply = readFileSync(shape);
  const start = ply.indexOf('end_header\n') + 11;
  const each = (ply.length - start) / cloud.length; // x y z as floats, red green blue, sigma
  cloud.forEach((point, i) => {
    const from = start + i * each;
    assert.deepEqual(point, [...[0, 4, 8].map((k) => ply.readFloatLE(from + k)), ply[from + 12], ply[from + 13], ply[from + 14]]);
  });
}

// Compares frame by frame.
function assertFrames(file: File, results: string): void {
  const { frames, tracked } = stats(results);
  const live = table(join(results, 'trajectory_live.txt'));
  assertRows(poseRows(file), live);
  assertRows(tfRows(cameras(file).slice(0, -1)), live);
  const states = file.on('/diagnostics').map(({ message }) => message.status);
  assert.equal(states.length, frames);
  assert.equal(states.filter(([state]) => state.level === 0).length, live.length);
  assert.ok(live.length <= tracked && live.length > 0);
  states.forEach(([state, ms], i) => {
    const value = (of: any, key: string) => of.values.find((each: any) => each.key === key)?.value;
    assert.equal(state.name, 'alidade: tracking');
    assert.equal(Number(value(state, 'frame')), i);
    assert.equal(state.message.startsWith('tracking'), state.level === 0);
    assert.ok(Number(value(ms, 'frame')) > 0, 'ms');
  });
}

test(`frames, poses, path and points are those of the results (${BINARY})`, options, () => {
  assertFrames(recorded, at('results'));
  assertEnd(recorded, at('results'));
  // At the end a final path is written; earlier ones grow with the run.
  const paths = recorded.on('/alidade/path').map(({ message }) => message.poses.length);
  assert.ok(paths.length >= 3 && paths[0] < paths[1]);
});

test('frames of coordinates hang together, upright', options, () => {
  const up = recorded.on('/tf').map(({ message }) => message.transforms.find((each: any) => each.header.frame_id === 'map'));
  assert.equal(up.length, recorded.on('/tf').length);
  for (const { child_frame_id, transform: { rotation: { x, y, z, w }, translation } } of up) {
    assert.equal(child_frame_id, 'map_optical');
    assert.deepEqual([translation.x, translation.y, translation.z], [0, 0, 0]);
    // The camera's y axis points down: -z of the map.
    const down = [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)];
    [0, 0, -1].forEach((value, k) => assert.ok(Math.abs(down[k] - value) < 1e-12));
  }
  for (const topic of ['/alidade/pose', '/alidade/path', '/alidade/landmarks', '/alidade/semidense'])
    for (const { message } of recorded.on(topic)) assert.equal(message.header.frame_id, 'map_optical');
  for (const { header } of cameras(recorded)) assert.equal(header.frame_id, 'map_optical');
  for (const { time, message } of recorded.told) {
    const stamp = (message.header ?? message.transforms?.[0].header ?? message).stamp;
    assert.equal(BigInt(stamp.sec) * 1000000000n + BigInt(stamp.nsec), time);
  }
});

test('pictures come with the camera that takes such', options, () => {
  const pictures = recorded.on('/camera/image/compressed');
  const infos = recorded.on('/camera/camera_info');
  assert.ok(pictures.length >= 15); // 2 seconds with 10 images per second
  assert.equal(infos.length, pictures.length);
  const { camera } = stats(at('results'));
  pictures.forEach(({ time, message }, i) => {
    assert.equal(message.format, 'jpeg');
    assert.equal(message.header.frame_id, 'camera_optical');
    const { width, height } = jpeg.decode(message.data);
    const info = infos[i].message;
    assert.equal(infos[i].time, time);
    assert.equal(info.header.frame_id, 'camera_optical');
    assert.deepEqual([info.width, info.height], [width, height]);
    assert.deepEqual([width, height], [camera.width, camera.height]); // smaller than stream.picture_width
    assert.deepEqual([...info.k], [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1]);
    assert.deepEqual([...info.p], [camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0]);
    assert.equal(info.distortion_model, 'plumb_bob');
    assert.deepEqual([...info.d], camera.distortion);
  });
});

test('types are those of ROS 2, and the file is whole', options, () => {
  const { reader, told } = recorded;
  for (const { name, encoding, data } of reader.schemasById.values()) {
    assert.equal(encoding, 'ros2msg');
    const definitions = parse(new TextDecoder().decode(data), { ros2: true });
    for (const definition of definitions) {
      const type = (definition.name ?? name).replace('/msg/', '/');
      const known = (ros2humble as any)[type];
      const plain = (fields: any[]) => fields.map(({ type: of, name: field, isArray, arrayLength, isConstant, value }) =>
        ({ of: of.replace('/msg/', '/'), field, isArray: isArray ?? false, arrayLength, value: isConstant ? Number(value) : undefined }));
      assert.deepEqual(plain(definition.definitions), plain(known.definitions), type);
    }
  }
  assert.equal(reader.header.profile, 'ros2');
  assert.match(reader.header.library, /^alidade \d/);
  for (const { messageEncoding, metadata } of reader.channelsById.values()) {
    assert.equal(messageEncoding, 'cdr');
    assert.ok(metadata.has('offered_qos_profiles'));
  }
  const { statistics } = reader;
  assert.equal(Number(statistics!.messageCount), told.length);
  assert.equal(statistics!.chunkCount, reader.chunkIndexes.length);
  assert.equal(statistics!.messageStartTime, told[0].time);
  assert.equal(statistics!.messageEndTime, told.at(-1)!.time);
  for (const [id, count] of statistics!.channelMessageCounts)
    assert.equal(Number(count), recorded.on(reader.channelsById.get(id)!.topic).length);
  assert.deepEqual(readThrough(at('run.mcap')), { messages: told.length, complete: true });
});

test('a recorded stream that is exported gives the same messages', options, async () => {
  await run('run', ...ROOM, '--record', '--set', 'expert.stream.whole_seconds=0.4', '--out', at('streamed'));
  await run('export', at('streamed'), '--to', 'mcap', at('exported.mcap'));
  const exported = await readIndexed(at('exported.mcap'));
  // Processing times differ; the path is compared below.
  const timeless = ({ told }: File) => told.filter(({ topic }) => topic !== '/diagnostics' && topic !== '/alidade/path')
    .map(({ topic, time, bytes }) => `${time} ${topic} ${Buffer.from(bytes).toString('base64')}`);
  assert.deepEqual(timeless(exported), timeless(recorded));
  // Paths after a whole state contain poses that were composed when keyframes were culled, with different rounding.
  const paths = (file: File) => file.on('/alidade/path').map(({ message }) => message.poses.map(({ header, pose }: any) => row(header.stamp, pose.position, pose.orientation)));
  assert.equal(paths(exported).length, paths(recorded).length);
  paths(exported).forEach((path, i) => assertRows(path, paths(recorded)[i]));
  assertFrames(exported, at('streamed'));
  assertEnd(exported, at('streamed'));
  // Without the stream: the same final state, and the live poses.
  rmSync(at('streamed/run.stream'));
  await run('export', at('streamed'), '--to', 'mcap', at('results.mcap'));
  const still = await readIndexed(at('results.mcap'));
  assertEnd(still, at('streamed'));
  assertRows(poseRows(still), table(at('streamed/trajectory_live.txt')));
  const [run_, ms] = still.on('/diagnostics').at(-1)!.message.status;
  assert.equal(run_.message, '60 of 60 frames tracked');
  assert.equal(Number(ms.values[0].value), Number(stats(at('streamed')).ms.frame.median.toFixed(2)));
  // From a map: its keyframes.
  await run('export', at('streamed/map.alidade'), '--to', 'mcap', at('map.mcap'));
  const map = await readIndexed(at('map.mcap'));
  assertRows(poseRows(map), table(at('streamed/keyframes.txt')));
  assert.equal(points(map.on('/alidade/landmarks')[0].message).length, vertices(at('streamed/landmarks.ply')));
  assert.equal(map.on('/alidade/semidense').length, 0); // saved maps do not contain it
});

async function interrupted(signal: NodeJS.Signals, name: string): Promise<number | null> {
  mkdirSync(at(name));
  const child = spawn(BINARY, ['run', 'synth:room?frames=3000&width=320&height=240', '--sensor', 'rgbd', '--quiet', '--set', 'stream.pictures_hz=1000', '--set',
    'stream.picture_quality=100', '--record-to', at(`${name}/run.mcap`), '--out', at(`${name}/results`)], { stdio: 'ignore' });
  const ended = new Promise<number | null>((done) => child.on('close', done));
  const written = () => readdirSync(at(name)).filter((file) => file.startsWith('run.mcap')).reduce((sum, file) => sum + statSync(at(`${name}/${file}`)).size, 0);
  while (child.exitCode === null && written() < 2e6) await new Promise((done) => setTimeout(done, 20));
  child.kill(signal);
  return ended;
}

test('Ctrl-C leaves a whole file, kill one that can be repaired beside its place', options, async () => {
  assert.equal(await interrupted('SIGINT', 'stopped'), 130);
  const stopped = await readIndexed(at('stopped/run.mcap'));
  assertFrames(stopped, at('stopped/results'));
  assertEnd(stopped, at('stopped/results'));
  assert.equal(await interrupted('SIGKILL', 'killed'), null);
  const [draft, ...others] = readdirSync(at('killed')).filter((file) => file.startsWith('run.mcap'));
  assert.match(draft, /^run\.mcap\.tmp/);
  assert.deepEqual(others, []);
  const { messages, complete } = readThrough(at(`killed/${draft}`));
  assert.ok(messages > 50 && !complete, `${messages} messages`);
});

test('a real pair of cameras: poses are of the camera as mounted, pictures of the rectified one', { ...options, skip: NO_BINARY || (DATA ? false : 'ALIDADE_DATA names no folder of recordings') }, async () => {
  await run('run', join(DATA ?? '', 'euroc_micro'), '--quiet', '--record-to', at('euroc.mcap'), '--out', at('euroc'));
  const euroc = await readIndexed(at('euroc.mcap'));
  assertFrames(euroc, at('euroc'));
  assertEnd(euroc, at('euroc'));
  assert.ok(euroc.on('/camera/camera_info').every(({ message }) => message.header.frame_id === 'camera_rectified_optical'));
  // The images and their camera are scaled down; the outer image edges coincide.
  const { camera } = stats(at('euroc'));
  const near = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);
  for (const { message: { width, height, k } } of euroc.on('/camera/camera_info')) {
    assert.equal(width, 400);
    assert.ok(camera.width > 700);
    near(k[0] / width, camera.fx / camera.width);
    near(k[4] / height, camera.fy / camera.height);
    near((k[2] + 0.5) / width, (camera.cx + 0.5) / camera.width);
    near((k[5] + 0.5) / height, (camera.cy + 0.5) / camera.height);
  }
  const { header, transform: { rotation } } = euroc.on('/tf')[0].message.transforms.find((each: any) => each.child_frame_id === 'camera_rectified_optical');
  assert.equal(header.frame_id, 'camera_optical');
  assert.ok(Math.hypot(rotation.x, rotation.y, rotation.z) > 1e-4 && rotation.w > 0.9);
  assert.ok(seconds(header.stamp) > 1.4e9);
});
