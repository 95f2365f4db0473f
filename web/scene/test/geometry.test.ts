import assert from 'node:assert/strict';
import { test } from 'node:test';
import { alignTruth, similarity } from '../src/align.ts';
import { decode } from '../src/decode.ts';
import { compose, inverse, rotate, transform } from '../src/pose.ts';
import { State } from '../src/state.ts';
import { upright } from '../src/upright.ts';
import { encode } from './encode.ts';
import { Random, Sample } from './sample.ts';

const random = new Random(3);
const draw = () => 2 * random.next() - 1;

function anyPose(): number[] {
  const q = [draw(), draw(), draw(), draw()];
  const norm = Math.hypot(...q);
  return [...q.map((value) => value / norm), 3 * draw(), 3 * draw(), 3 * draw()];
}

const near = (a: readonly number[], b: readonly number[], bound = 1e-9) =>
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) < bound, `${a} is not ${b}`));

test('a pose and its inverse undo each other; composing is doing one after the other', () => {
  for (let i = 0; i < 50; ++i) {
    const [T, S] = [anyPose(), anyPose()];
    const p: [number, number, number] = [draw(), draw(), draw()];
    near(transform(inverse(T), 1, ...transform(T, 1, ...p)), p);
    near(transform(compose(T, 2, S), 1, ...p), transform(T, 1, ...(rotate(S, ...p).map((v, k) => v + 2 * S[4 + k]) as [number, number, number])));
  }
});

test('the similarity between two clouds is found, with and without a scale', () => {
  for (let i = 0; i < 50; ++i) {
    const T = anyPose();
    const scale = i % 2 === 0 ? 1 : 0.2 + 3 * random.next();
    const a = [...Array(20)].map(() => [draw(), draw(), draw()]);
    const b = a.map((p) => transform(T, scale, p[0], p[1], p[2]));
    const fit = similarity(a, b, scale !== 1)!;
    assert.ok(Math.abs(fit.scale - scale) < 1e-9);
    a.forEach((p, k) => near(transform(fit.T, fit.scale, p[0], p[1], p[2]), b[k]));
  }
  assert.equal(similarity([[1, 2, 3], [1, 2, 3]], [[0, 0, 0], [1, 1, 1]], true), null);
});

test('once its loop is closed, the path of the sample lies near the truth', () => {
  const sample = new Sample({ frames: 400, landmarks: 500, depthPoints: 10, pictures: false });
  const state = new State();
  state.apply(decode(encode(sample.hello())));
  for (let i = 0; i < 400; ++i) for (const message of sample.step(i)) state.apply(decode(encode(message)));
  const { rmse, worst, truth, errors } = alignTruth(state, 0)!;
  assert.ok(rmse > 0.001 && rmse < 0.2 && worst >= rmse && worst < 0.5, `${rmse} ${worst}`);
  assert.equal(truth.length, 400);
  assert.ok(Number.isNaN(errors[0]) && errors[20] >= 0);
});

test('up is what hand-held cameras think it is, however much they look down', () => {
  const down = 0.6; // radians
  const poses = [...Array(40).keys()].map((i) => {
    const turn = (2 * Math.PI * i) / 40;
    return compose([0, Math.sin(turn / 2), 0, Math.cos(turn / 2), 0, 0, 0], 1, [-Math.sin(down / 2), 0, 0, Math.cos(down / 2), 0, 0, 0]);
  });
  near(upright(poses).up, [0, -1, 0], 1e-6);
  near(upright(poses, [0, 0, -2]).up, [0, 0, -1], 1e-12); // known
  const { right, forward, up } = upright([]);
  near(right, [1, 0, 0]);
  near(forward, [0, 0, 1]);
  near(up, [0, -1, 0]);
});
