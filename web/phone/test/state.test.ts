// The page's state in Node: what each message changes, and what the page then says.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Sample } from '../../scene/test/sample.ts';
import type { Frame, Inertial } from '../../core/src/index.ts';
import { lengthText, pathText, rulerText } from '../src/lengths.ts';
import { PageState } from '../src/page_state.ts';
import type { Done } from '../src/protocol.ts';
import { DEFAULTS } from '../src/settings.ts';
import { lensText, statusOf } from '../src/words.ts';

const FRAME: Frame = {
  number: 0, state: 'tracking', pose: null, predicted: null, failure: null, reason: '', counts: { keyframes: 5, landmarks: 300, matches: 80, features: 500, maps: 1 },
  milliseconds: 8, fov: 62, fovSigma: 0, cameraChanges: 0, orientation: null,
};
const done = (frame: Partial<Frame> = {}, bitmap: { close(): void } | null = null): Done =>
  ({ kind: 'done', number: 0, time: 0, light: 100, messages: [], turn: 0, bitmap: bitmap as ImageBitmap | null, inertial: null, spreads: {}, frame: { ...FRAME, ...frame } });
const messages = () => [...new Sample({ frames: 30, landmarks: 200, depthPoints: 0, pictures: false }).messages()];
const running = () => {
  const state = new PageState({ ...DEFAULTS });
  state.apply({ kind: 'phase', phase: 'running' });
  state.apply({ kind: 'begin', remote: false, fov: null });
  return state;
};

test('an image that was processed brings its map, its numbers and itself', () => {
  const state = running();
  const before = state.revision;
  state.apply({ kind: 'done', done: done(), messages: messages() });
  assert.ok(state.map.keyframes.size > 0 && state.map.landmarks.size > 0);
  assert.equal(state.shown?.frame.counts.matches, 80);
  assert.deepEqual(state.counters, { processed: 1, milliseconds: [8] });
  assert.ok(state.revision > before);
});

test('the image before is released when another takes its place, and when the session ends', () => {
  const state = running();
  const closed: string[] = [];
  state.apply({ kind: 'done', done: done({}, { close: () => closed.push('first') }), messages: [] });
  state.apply({ kind: 'done', done: done({}, { close: () => closed.push('second') }), messages: [] });
  assert.deepEqual(closed, ['first']);
  state.apply({ kind: 'reset' });
  assert.deepEqual(closed, ['first', 'second']);
});

test('another map, and another session, begin empty', () => {
  for (const kind of ['anew', 'reset', 'begin'] as const) {
    const state = running();
    state.apply({ kind: 'notice', about: 'record', text: 'a notice' });
    state.apply({ kind: 'done', done: done(), messages: messages() });
    const { map, revision } = state;
    state.apply(kind === 'begin' ? { kind, remote: true, fov: 60 } : { kind });
    assert.notEqual(state.map, map);
    assert.equal(state.map.keyframes.size, 0);
    assert.ok(state.revision > revision);
    assert.equal(state.shown === null, kind !== 'anew', kind);
    assert.equal(state.notices.size, kind === 'anew' ? 1 : 0, kind);
    assert.deepEqual(state.session, { anew: { remote: false, fov: null }, reset: null, begin: { remote: true, fov: 60 } }[kind]);
  }
});

test('a notice replaces the one of its topic', () => {
  const state = running();
  state.apply({ kind: 'notice', about: 'camera', text: 'one' });
  state.apply({ kind: 'notice', about: 'record', text: 'two' });
  state.apply({ kind: 'notice', about: 'camera', text: 'three' });
  assert.deepEqual([...state.notices.values()], ['three', 'two']);
  state.apply({ kind: 'notice', about: 'camera', text: '' });
  assert.deepEqual([...state.notices.values()], ['two']);
});

test('the page says what it does at each moment', () => {
  const state = new PageState({ ...DEFAULTS });
  assert.equal(statusOf(state).word, 'Ready');
  state.apply({ kind: 'phase', phase: 'running' });
  state.apply({ kind: 'begin', remote: false, fov: null });
  assert.equal(statusOf(state).word, 'Loading');
  state.apply({ kind: 'done', done: done({ state: 'initializing', failure: 'little_motion', reason: 'the camera hardly moves' }), messages: [] });
  assert.deepEqual(statusOf(state), { word: 'Starting', advice: 'Move sideways, slowly.' });
  state.apply({ kind: 'done', done: done(), messages: [] });
  assert.deepEqual(statusOf(state), { word: 'Tracking', advice: 'Tap a surface to put a cube on it.' });
  state.apply({ kind: 'phase', phase: 'ended' });
  assert.deepEqual(statusOf(state), { word: 'Ended', advice: 'The results can be saved.' });
  assert.ok(state.savable);
  state.apply({ kind: 'done', done: done({ state: 'lost' }), messages: [] }); // was under way
  assert.equal(statusOf(state).word, 'Ended');
});

test('the ruler says what is missing, what to tap, and the distance as exactly as it is known', () => {
  const inertial: Inertial = { samples: 9, metric: false, scaleSigma: 0, gravity: null, gravitySigma: 0, timeOffset: 0, timeOffsetSigma: 0, missing: 'scale is not observable yet', leftOut: '' };
  const state = running();
  state.apply({ kind: 'motion', motion: 'on' });
  state.apply({ kind: 'done', done: { ...done(), inertial }, messages: messages() });
  assert.equal(rulerText(state), '');
  state.apply({ kind: 'measuring', measuring: true });
  assert.match(statusOf(state).advice, /^Lengths are not known yet: move the phone sideways/);
  state.apply({ kind: 'done', done: { ...done(), inertial: { ...inertial, leftOut: 'the readings are of another device' } }, messages: [] });
  assert.equal(rulerText(state), 'The readings are of another device.');
  for (const [motion, text] of [['refused', /refused.*no unit/], ['none', /no motion sensor/]] as const) {
    state.apply({ kind: 'motion', motion });
    assert.match(rulerText(state), text);
  }
  state.apply({ kind: 'done', done: { ...done(), inertial: { ...inertial, metric: true, scaleSigma: 0.02 } }, messages: [] });
  assert.equal(rulerText(state), 'Tap two points to measure between them.');
  assert.match(pathText(state), /^Path \d+\.\d m ± 2 %$/);
  state.apply({ kind: 'measuring', measuring: false });
  assert.equal(statusOf(state).advice, 'Tap a surface to put a cube of 10 cm on it.');
  assert.equal(lengthText({ length: 0.8312, sigma: 0.0042 }), '83.1 ± 0.4 cm');
  assert.equal(lengthText({ length: 0.8312, sigma: 0.0242 }), '83 ± 2 cm');
  assert.equal(lengthText({ length: 4.5678, sigma: 0.12 }), '4.57 ± 0.12 m');
  assert.equal(lengthText({ length: 0.8312, sigma: Infinity }), 'about 83 cm');
});

test('without a map there is nothing to save', () => {
  const state = running();
  assert.equal(state.savable, false);
  state.apply({ kind: 'done', done: done({ state: 'initializing', counts: { ...FRAME.counts, keyframes: 0 } }), messages: [] });
  assert.equal(state.savable, false);
  state.apply({ kind: 'phase', phase: 'ended' });
  assert.deepEqual(statusOf(state), { word: 'Ended', advice: 'There is no map to save.' });
});

test('the lens is said with what the number is of', () => {
  assert.equal(lensText({ ...FRAME, fov: 63.04, fovSigma: 0.72 }, false), 'Field of view 63.0° ± 0.7°, found');
  assert.equal(lensText({ ...FRAME, fov: 66, fovSigma: 10 }, false), 'Field of view 66°, assumed');
  assert.equal(lensText({ ...FRAME, fov: 66 }, true), 'Field of view 66°, given');
});

test('images go to another computer only where the server can work on them', () => {
  const state = new PageState({ ...DEFAULTS, connected: true });
  assert.equal(state.remote, false); // not known yet
  for (const [info, remote] of [[{}, false], [{ connected: false, core: true }, false], [{ connected: true, core: true }, true]] as const) {
    state.apply({ kind: 'info', info });
    assert.equal(state.remote, remote);
  }
  state.apply({ kind: 'choices', choices: { ...DEFAULTS, connected: false } });
  assert.equal(state.remote, false);
  state.apply({ kind: 'info', info: { connected: true, core: false } });
  assert.equal(state.remote, true); // there is no core for the page
});
