// The phone page: camera or video → engine (core.wasm in a Worker, or another computer) → image, map, numbers.
import { decode, DecodeError, State } from '@alidade/scene';
import { byId, write } from '../../shared/src/dom.ts';
import { STATE_WORDS } from '../../shared/src/words.ts';
import { CameraProblem, holdFocus, openCamera, workingSize } from './camera.ts';
import { Cube } from './cube.ts';
import { DetectorHost } from './detector.ts';
import { LocalEngine } from './engine.ts';
import type { Engine, Hooks } from './engine.ts';
import { MapView } from './map_view.ts';
import { PictureView } from './picture.ts';
import type { Done } from './protocol.ts';
import { Recorder } from './recorder.ts';
import { RemoteEngine } from './remote.ts';
import { download, showOffers } from './save.ts';
import type { Offer } from './save.ts';
import { bind, coreSettings, detectorClasses, load } from './settings.ts';
import { VideoFile } from './video_file.ts';
import { advice, lensText } from './words.ts';

declare const BUNDLED: readonly { name: string; version: string; licence: string }[];
declare const PROGRAM: string;

type Phase = 'idle' | 'running' | 'ended';

const choices = load();
const video = byId('video') as HTMLVideoElement;
const picture = new PictureView();
const map = new MapView(() => state);
const detector = new DetectorHost(choices, (text) => notice(text, 'detector'));
const notices = new Map<string, string>(); // by topic
let state = new State();
let phase: Phase = 'idle';
let engine: Engine | null = null;
let stream: MediaStream | null = null;
let file: VideoFile | null = null;
let recorder: Recorder | null = null;
let cube: Cube | null = null;
let shown: Done | null = null;
let angle = 0; // screen rotation at the start, degrees
let upright = false; // whether the image was in portrait orientation at the start
let lastTime = -1; // time of the last camera image, seconds
let grab: { canvas: OffscreenCanvas; context: OffscreenCanvasRenderingContext2D } | null = null;
let focusHeld = false;
let wake: WakeLockSentinel | null = null;
let info: { connected?: boolean; core?: boolean; threads?: boolean } = {}; // info.json: the server's capabilities
const counters = { processed: 0, milliseconds: [] as number[] };
let watch: ((done: Done) => void) | null = null; // for tests

function notice(text: string, about: string): void {
  if (text) notices.set(about, text);
  else notices.delete(about);
  const all = [...notices.values()].join(' ');
  write(byId('notice'), all);
  byId('notice').hidden = all === '';
}

function setPhase(next: Phase): void {
  phase = next;
  document.body.dataset.phase = next;
  byId('again').hidden = next !== 'ended';
  byId('progress').hidden = file === null || next !== 'running';
}

const hooks: Hooks = {
  done(done) {
    ++counters.processed;
    counters.milliseconds.push(done.frame.milliseconds);
    if (counters.milliseconds.length > 1000) counters.milliseconds.shift();
    take(done.messages);
    shown?.bitmap?.close();
    shown = done;
    draw();
    tell(done);
    watch?.(done);
  },
  messages(messages) {
    take(messages);
    draw();
  },
  failed(text) { end(`The core has stopped: ${text}. What there is can be saved; Start anew begins again.`); },
  lost(text) { notice(text, 'connection'); },
};

function take(messages: readonly Uint8Array[]): void {
  for (const bytes of messages) {
    try {
      const message = decode(bytes);
      if (message.kind === 'hello' && engine instanceof RemoteEngine && engine.beginsAnew() && state.hello) {
        state = new State();
        map.forget();
        setCube(null);
      }
      cube?.follow(message);
      state.apply(message);
    } catch (error) {
      if (!(error instanceof DecodeError)) throw error;
      notice(`A message of the core could not be read: ${error.message}.`, 'message');
    }
  }
  if (cube && !cube.position(state)) setCube(null);
  map.changed();
}

function draw(): void {
  if (!shown?.bitmap) return;
  picture.show(shown.bitmap, shown.turn, state.frame, cube, state, choices.features);
}

function tell({ frame, light }: Done): void {
  const { keyframes, landmarks, matches } = frame.counts;
  const numbers = { keyframes, landmarks, matches, milliseconds: Math.round(frame.milliseconds) };
  for (const [name, value] of Object.entries(numbers)) write(document.querySelector(`[data-count=${name}]`)!, String(value));
  document.body.dataset.state = frame.state;
  document.body.dataset.frames = String(counters.processed);
  write(byId('state-word'), STATE_WORDS[frame.state]);
  write(byId('advice'), advice(frame, light) || (frame.state === 'tracking' && !cube && keyframes > 3 ? 'Tap a surface to put a cube on it.' : ''));
  write(byId('lens'), lensText(frame, choices.fov !== null));
}

function setCube(next: Cube | null): void {
  cube = next;
  byId('remove').hidden = next === null;
  draw();
}

// Creates a new engine and an empty state for images of this size.
async function begin(width: number, height: number): Promise<void> {
  engine?.close();
  forget();
  grab = null;
  const remote = Boolean(info.connected && (choices.connected || info.core === false));
  engine = remote ? new RemoteEngine(hooks) : new LocalEngine(hooks, info.threads ?? false);
  angle = screen.orientation?.angle ?? 0;
  upright = height > width;
  write(byId('state-word'), 'Loading');
  write(byId('advice'), remote ? 'Asking for the computer that does the work …' : 'The core (4 MB, the first time) …');
  const classes = remote ? [] : detectorClasses(choices);
  await engine.begin({ ...workingSize(width, height), fov: choices.fov, settings: coreSettings(choices), classes });
  if (classes.length > 0) detector.connect(engine as LocalEngine);
}

function forget(): void {
  state = new State();
  map.forget();
  map.changed();
  setCube(null);
  shown?.bitmap?.close();
  shown = null;
  lastTime = -1;
  counters.processed = 0;
  counters.milliseconds = [];
  for (const about of [...notices.keys()]) notice('', about);
}

async function startCamera(): Promise<void> {
  await asked;
  const button = byId('start') as HTMLButtonElement;
  button.disabled = true;
  try {
    stream = await openCamera();
    watchTrack();
    video.srcObject = stream;
    await video.play();
    setPhase('running');
    await begin(video.videoWidth, video.videoHeight);
    focusHeld = false;
    if (choices.focus) void holdFocus(stream).then((held) => { focusHeld = held; });
    await stayAwake();
    video.requestVideoFrameCallback(onPicture);
  } catch (error) {
    stopCamera();
    setPhase('idle');
    notice(error instanceof CameraProblem ? error.message : `It could not begin: ${(error as Error).message}.`, 'start');
  } finally {
    button.disabled = false;
  }
}

const onPicture: VideoFrameRequestCallback = (now, { mediaTime }) => {
  if (phase !== 'running' || !stream) return;
  video.requestVideoFrameCallback(onPicture);
  const time = mediaTime > 0 ? mediaTime : now / 1000;
  if (time <= lastTime) return;
  lastTime = time;
  if (recorder) {
    recorder.add(video, time);
    write(byId('record'), `Recording ${recorder.pictures}`);
    if (recorder.full) void stopRecording('The recording is as large as a page can hold: it has been ended.');
  }
  if (!engine?.free) return;
  engine.push(grabbed(), time, turned());
};

function grabbed(): ImageBitmap {
  const { videoWidth: width, videoHeight: height } = video;
  if (!grab || grab.canvas.width !== width || grab.canvas.height !== height) {
    const canvas = new OffscreenCanvas(width, height);
    grab = { canvas, context: canvas.getContext('2d')! };
  }
  grab.context.drawImage(video, 0, 0, width, height);
  return grab.canvas.transferToImageBitmap();
}

// Browsers rotate the camera image with the phone. Returns the clockwise quarter turns that undo this, so that the lens
// model remains valid.
function turned(): number {
  const quarters = Math.round(((screen.orientation?.angle ?? 0) - angle) / 90) & 3;
  const changed = (video.videoHeight > video.videoWidth) !== upright;
  if (changed) return quarters % 2 ? quarters : 1;
  return quarters === 2 ? 2 : 0;
}

async function openFile(chosen: File): Promise<void> {
  stopCamera();
  file?.close();
  file = null;
  await asked;
  try {
    const opened = await VideoFile.open(video, chosen);
    file = opened;
    setPhase('running');
    await begin(video.videoWidth, video.videoHeight);
    await stayAwake();
    byId('progress').hidden = false;
    for (let next = await opened.next(); next && file === opened; next = await opened.next()) {
      while (!engine!.free && file === opened && phase === 'running') await new Promise((resolve) => { setTimeout(resolve, 1); });
      if (file !== opened || phase !== 'running') {
        next.bitmap.close();
        return;
      }
      engine!.push(next.bitmap, next.time, 0);
      (byId('progress-bar') as HTMLProgressElement).value = opened.share;
      write(byId('progress-text'), `${next.time.toFixed(1)} of ${opened.duration.toFixed(1)} s`);
    }
    while (engine && !engine.free) await new Promise((resolve) => { setTimeout(resolve, 5); });
    if (file === opened) end('');
  } catch (error) {
    file?.close();
    file = null;
    setPhase(engine && shown ? 'ended' : 'idle');
    notice(`${chosen.name} was not opened: ${(error as Error).message}.`, 'start');
  }
}

function stopCamera(): void {
  for (const track of stream?.getTracks() ?? []) track.stop();
  stream = null;
  video.srcObject = null;
  void wake?.release();
  wake = null;
}

// `why`: reason for an abnormal end, or '': then the whole map is adjusted once more.
function end(why: string): void {
  if (phase !== 'running') return;
  if (recorder) void stopRecording('');
  stopCamera();
  file?.close();
  file = null;
  setPhase('ended');
  write(byId('state-word'), 'Ended');
  write(byId('advice'), why ? '' : 'What there is can be saved.');
  if (why) notice(why, 'end');
  else void engine?.ask('finish').then(() => draw()).catch((error: Error) => notice(`The last adjustment failed: ${error.message}.`, 'end'));
}

async function stopRecording(why: string): Promise<void> {
  const done = recorder;
  recorder = null;
  byId('record').setAttribute('aria-pressed', 'false');
  write(byId('record'), 'Record');
  if (why) notice(why, 'record');
  if (!done) return;
  try {
    download(await done.finish(choices.fov === null ? '' : cameraYaml()), `${done.name}.zip`);
  } catch (error) {
    notice(`The recording could not be kept: ${(error as Error).message}.`, 'record');
  }
}

function toggleRecording(): void {
  if (recorder) return void stopRecording('');
  recorder = new Recorder({
    userAgent: navigator.userAgent, width: video.videoWidth, height: video.videoHeight, focusHeld, fov: choices.fov, began: new Date().toISOString(),
  });
  byId('record').setAttribute('aria-pressed', 'true');
  // iOS asks the user for permission to use the motion sensors.
  const asks = DeviceMotionEvent as unknown as { requestPermission?(): Promise<string> } | undefined;
  void asks?.requestPermission?.().catch(() => {});
}

// camera.yaml with the chosen field of view, for images of the recording's size.
function cameraYaml(): string {
  const { videoWidth: width, videoHeight: height } = video;
  const focal = width / (2 * Math.tan(((choices.fov ?? 66) * Math.PI) / 360));
  return `width: ${width}\nheight: ${height}\nfx: ${focal.toFixed(3)}\nfy: ${focal.toFixed(3)}\ncx: ${(width - 1) / 2}\ncy: ${(height - 1) / 2}\n`;
}

function offerFiles(): void {
  const of = (what: 'map' | 'trajectory' | 'cloud', type: string) => async () => new Blob([await engine!.ask(what)], { type });
  const offers: Offer[] = engine === null ? [] : [
    { name: 'map.alidade', what: 'Map: alidade view, alidade run --load', bytes: of('map', 'application/octet-stream') },
    { name: 'trajectory.txt', what: 'Path of the camera (TUM format)', bytes: of('trajectory', 'text/plain') },
    { name: 'landmarks.ply', what: 'Map points (PLY): MeshLab, CloudCompare', bytes: of('cloud', 'application/octet-stream') },
  ];
  const remote = engine instanceof RemoteEngine;
  showOffers(remote ? [] : offers, remote ? 'The computer that does the work keeps the map, when it was started with --out.' : engine ? 'Lengths are in map units: one camera cannot tell metres. Record keeps the pictures themselves.' : 'Nothing yet.',
    (text) => notice(text, 'save'));
}

function watchTrack(): void {
  stream?.getVideoTracks()[0]?.addEventListener('ended', () => {
    if (phase === 'running' && stream && document.visibilityState === 'visible') void reopen();
  });
}

// Reopens the camera after the system took it, or while the page was hidden. The map is kept, and the camera
// relocalizes.
async function reopen(): Promise<void> {
  if (!stream) return;
  try {
    stream = await openCamera();
    watchTrack();
    video.srcObject = stream;
    await video.play();
    video.requestVideoFrameCallback(onPicture);
    notice('', 'camera');
  } catch (error) {
    notice((error as Error).message, 'camera');
  }
}

async function stayAwake(): Promise<void> {
  try {
    wake = await navigator.wakeLock?.request('screen') ?? null;
  } catch {
    // not permitted now (low battery): the screen may turn off
  }
}

document.addEventListener('visibilitychange', () => {
  if (document.visibilityState !== 'visible' || phase !== 'running') return;
  void stayAwake();
  if (file) return;
  if (stream?.getVideoTracks()[0]?.readyState !== 'live') void reopen();
  else void video.play().catch(() => {});
});

byId('start').addEventListener('click', () => void startCamera());
byId('stop').addEventListener('click', () => end(''));
byId('again').addEventListener('click', () => {
  engine?.close();
  engine = null;
  forget();
  setPhase('idle');
});
byId('file').addEventListener('change', (event) => {
  const input = event.target as HTMLInputElement;
  const chosen = input.files?.[0];
  input.value = '';
  if (chosen) void openFile(chosen);
});
document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', (event) => {
  event.preventDefault();
  const chosen = event.dataTransfer?.files[0];
  if (chosen) void openFile(chosen);
});
byId('picture').addEventListener('pointerup', (event) => {
  const tap = picture.at(event, state);
  if (!tap || document.body.dataset.state !== 'tracking') return;
  const placed = Cube.place(state, tap);
  if (placed) setCube(placed);
  notice(placed ? '' : 'There are no map points near there yet: look at it a little longer.', 'cube');
});
byId('remove').addEventListener('click', () => setCube(null));
byId('record').addEventListener('click', toggleRecording);
byId('save-open').addEventListener('click', offerFiles);
byId('settings-open').addEventListener('click', () => (byId('settings') as HTMLDialogElement).showModal());
bind(choices, draw);
write(byId('about'), `${PROGRAM}. Built with ${BUNDLED.map(({ name, version, licence }) => `${name} ${version} (${licence})`).join(', ')}.`);
if (document.body.classList.contains('no-webgl')) notice('This browser shows no 3D: the picture and the numbers are here, the map is not.', 'webgl');

async function askInfo(): Promise<void> {
  try {
    const answer = await fetch('info.json' + location.search);
    if (answer.ok) info = await answer.json() as typeof info;
  } catch {
    // offline, or a static file server: the core runs in the page
  }
  byId('set-connected-row').hidden = !(info.connected && info.core !== false);
  if (info.connected) write(byId('unless'), info.core === false ? ': they go to the computer that serves this page, which does the work.' : ', unless you have the computer that serves this page do the work.');
}
const asked = askInfo();

if ('serviceWorker' in navigator && isSecureContext) {
  void navigator.serviceWorker.register('sw.js' + location.search).then(({ installing, waiting, active }) => {
    document.body.dataset.offline = active ? 'ready' : 'soon';
    (installing ?? waiting)?.addEventListener('statechange', function changed() { if (this.state === 'activated') document.body.dataset.offline = 'ready'; });
  }).catch(() => {}); // then the page does not work offline
}

// For tests and debugging.
Object.assign(window, {
  phone: {
    get state() { return state; },
    get engine() { return engine; },
    get cube() { return cube; },
    get shown() { return shown; },
    get scene() { return map.scene; },
    detector,
    counters,
    watch(hook: (done: Done) => void) { watch = hook; },
  },
});
