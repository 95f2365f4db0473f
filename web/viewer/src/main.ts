// The viewer's page: messages arrive, the player holds the state, and the parts draw it at most once per display frame.
import { alignTruth, DecodeError, NoWebGL, Scene, StreamFileReader } from '@alidade/scene';
import type { Pose, ViewMode } from '@alidade/scene';
import { sceneColours } from '../../shared/src/colours.ts';
import { byId, write } from '../../shared/src/dom.ts';
import { fillAbout } from './about.ts';
import { Connection, query } from './connection.ts';
import { keys } from './keys.ts';
import { layerSwitches, Panel } from './panel.ts';
import { Picture } from './picture.ts';
import { Player } from './player.ts';
import { Plot } from './plot.ts';
import { Ruler } from './ruler.ts';
import { saveImage } from './snapshot.ts';
import { StillMap } from './still_map.ts';
import { onTheme } from './theme.ts';
import { Timeline } from './timeline.ts';

const MOST_BYTES = 1.5e9; // bytes of a recorded stream that a page can hold

let player = new Player();
let replay = false;
let connection: Connection | null = null;
let dirty = true;
let before = performance.now();
const notices = new Map<string, string>(); // by topic
let fresh = false; // a connection was opened but no message has arrived yet

const seek = (number: number) => {
  player.seek(number);
  dirty = true;
};
const picture = new Picture();
const plot = new Plot();
const timeline = new Timeline(() => player, seek);
const panel = new Panel(() => player, seek);
const scene = makeScene();
const ruler = scene && new Ruler(scene, () => player.shown.unit, (text) => notice(text, 'measure'));
let still: StillMap | null = null;

function makeScene(): Scene | null {
  try {
    const made = new Scene(byId('scene') as HTMLCanvasElement);
    return made;
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    document.body.classList.add('no-webgl');
    notice('This browser cannot show 3D (WebGL 2 is missing or disabled): the map is missing, image and numbers are shown.', 'webgl');
    return null;
  }
}

function notice(text: string, about: string): void {
  if (text) notices.set(about, text);
  else notices.delete(about);
  const all = [...notices.values()].join(' ');
  write(byId('notice'), all);
  byId('notice').hidden = all === '';
}

function receive(bytes: Uint8Array): void {
  try {
    if (fresh) {
      fresh = false;
      reset();
    }
    player.push(bytes);
    notice('', 'message');
    if (player.latest.incomplete) {
      player.latest.incomplete = false;
      connection?.ask('whole');
    }
  } catch (error) {
    if (!(error instanceof DecodeError)) throw error;
    notice(`A message of the stream could not be read: ${error.message}.`, 'message');
  }
  dirty = true;
}

function reset(): void {
  player.reset();
  panel.reset();
  picture.forget();
  plot.forget();
  timeline.refresh();
  scene?.forget();
  panel.error(null, player.latest);
  aligned = { version: -1n, length: 0, time: 0 };
}

function connect(): void {
  connection = new Connection({
    opened() {
      document.body.dataset.connection = 'open';
      fresh = true;
      notice('', 'connection');
    },
    message: receive,
    closed() {
      document.body.dataset.connection = 'closed';
      const over = player.latest.playback?.finished;
      notice(over ? 'The program has ended. The page keeps what it has received and continues when the program is started again.'
        : 'No connection: the program has ended or has not started yet. Trying again …', 'connection');
    },
  });
}

async function loadRecorded(): Promise<void> {
  replay = true;
  player = new Player(MOST_BYTES);
  document.body.classList.add('replay');
  document.body.dataset.connection = 'replay';
  const response = await fetch('run.stream' + query());
  if (!response.ok || !response.body) throw new Error(`run.stream: ${response.status} ${response.statusText}`);
  const reader = new StreamFileReader();
  const body = response.body.getReader();
  let total = 0;
  for (;;) {
    const { done, value } = await body.read();
    if (done) break;
    total += value.byteLength;
    if (total > MOST_BYTES) {
      notice('The recording is larger than this page can hold: the end is not shown.', 'file');
      await body.cancel();
      break;
    }
    for (const bytes of reader.push(value)) receive(bytes);
  }
  if (reader.rest > 0 && total <= MOST_BYTES) notice('The end of the recording is missing: the program was stopped while writing.', 'file');
}

async function begin(): Promise<void> {
  try {
    const response = await fetch('info.json' + query());
    const info = response.ok ? await response.json() as { mode?: string; title?: string; T_world_cloud?: Pose; T_world_mesh?: Pose } : {};
    if (info.title) document.title = `${info.title} – Alidade`;
    if (info.mode === 'replay') return await loadRecorded();
    if (info.mode === 'map') showStill(info.T_world_cloud, info.T_world_mesh);
  } catch (error) {
    if (replay) {
      notice(`The recording could not be read: ${(error as Error).message}.`, 'file');
      return;
    }
  }
  connect();
}

function showStill(T_world_cloud: Pose | undefined, T_world_mesh: Pose | undefined): void {
  still = new StillMap(scene, switches);
  picture.hidden = true;
  if (T_world_mesh) {
    void still.loadMesh(T_world_mesh).catch((error: Error) => notice(`mesh.ply could not be read: ${error.message}.`, 'cloud')).finally(() => { dirty = true; });
  } else if (T_world_cloud) {
    void still.load(T_world_cloud).catch((error: Error) => notice(`semidense.ply could not be read: ${error.message}.`, 'cloud')).finally(() => { dirty = true; });
  }
}

// The buttons control the program (if it can pause) when the current state is shown, otherwise the playback of the
// past.
function paused(): boolean {
  if (player.attached && !replay) return Boolean(player.latest.playback?.paused);
  return !player.playing;
}

function togglePlay(): void {
  const { playback } = player.latest;
  if (player.attached && !replay && playback?.mayPause && !playback.finished) connection?.ask(playback.paused ? 'resume' : 'pause');
  else if (player.attached && !replay) player.detach();
  else if (player.playing) player.playing = false;
  else player.play();
  dirty = true;
}

function step(by: number): void {
  const { playback } = player.latest;
  if (by > 0 && player.attached && !replay && playback?.mayPause && !playback.finished) connection?.ask(playback.paused ? 'step' : 'pause');
  else player.step(by);
  dirty = true;
}

function goLive(): void {
  player.attach();
  dirty = true;
}

function setView(mode: ViewMode): void {
  scene?.setMode(mode);
  for (const button of document.querySelectorAll<HTMLElement>('[data-view]')) {
    button.setAttribute('aria-pressed', String(button.dataset.view === mode));
  }
}

const narrow = matchMedia('(max-width: 760px)');

// On wide screens a panel that is open by default, on narrow screens a sheet that is closed by default.
function togglePanel(): void {
  const open = narrow.matches ? document.body.classList.toggle('sheet-open') : !document.body.classList.toggle('panel-closed');
  byId('panel-toggle').setAttribute('aria-expanded', String(open));
}

function update(): void {
  const { shown } = player;
  document.body.dataset.shown = player.attached ? 'now' : 'past';
  document.body.classList.toggle('paused', paused());
  write(byId('play-word'), paused() ? 'Go on' : 'Pause');
  panel.update(shown);
  picture.update(shown);
  plot.update(player);
  plot.draw();
  timeline.update();
  scene?.update(shown);
  switches.get('others')!.parentElement!.hidden = !scene?.several;
  still?.update(shown, () => {
    setView('orbit');
    scene?.fit();
  });
}

// Realigns the ground truth when the map changed or the path grew by 30 frames, at most once per second.
let aligned = { version: -1n, length: 0, time: 0 };
function overlayTruth(now: number): void {
  const { shown } = player;
  if (!shown.hello?.truth.length || now - aligned.time < 1000) return;
  if (shown.mapVersion === aligned.version && Math.abs(shown.path.length - aligned.length) < 30) return;
  aligned = { version: shown.mapVersion, length: shown.path.length, time: now };
  const alignment = alignTruth(shown, shown.activeMap);
  scene?.overlay(alignment);
  panel.error(alignment, shown);
  dirty = true;
}

function layout(): void {
  if (!scene) return;
  if (narrow.matches) return scene.insets(0, 0);
  const { right } = picture.hidden ? { right: 0 } : byId('picture').getBoundingClientRect();
  const panelWidth = document.body.classList.contains('panel-closed') ? 0 : byId('panel').offsetWidth + 12;
  scene.insets(right < innerWidth / 2 ? right : 0, panelWidth);
}

function tick(now: number): void {
  const seconds = Math.min(0.5, (now - before) / 1000);
  before = now;
  if (player.tick(seconds, !replay)) dirty = true;
  overlayTruth(now);
  if (dirty) {
    dirty = false;
    update();
  }
  requestAnimationFrame(tick);
}

const sizes = new ResizeObserver(layout);
for (const id of ['scene', 'picture', 'panel']) sizes.observe(byId(id));
onTheme(() => {
  scene?.colours(sceneColours());
  plot.make();
  timeline.refresh();
  picture.reset();
  dirty = true;
});
const switches = layerSwitches((layer, visible) => scene?.show(layer, visible));
for (const button of document.querySelectorAll<HTMLElement>('[data-view]')) {
  button.addEventListener('click', () => setView(button.dataset.view as ViewMode));
}
byId('fit').addEventListener('click', () => scene?.fit());
const snapshot = () => {
  if (scene && ruler) void saveImage(scene, ruler, player.shown.hello?.source ?? '').catch((error: Error) => notice(`The image could not be saved: ${error.message}.`, 'snapshot'));
};
byId('measure').addEventListener('click', () => ruler?.toggle());
byId('snapshot').addEventListener('click', snapshot);
byId('play').addEventListener('click', togglePlay);
byId('step').addEventListener('click', () => step(1));
byId('live').addEventListener('click', goLive);
byId('panel-toggle').addEventListener('click', togglePanel);
byId('speed').addEventListener('change', (event) => { player.speed = Number((event.target as HTMLSelectElement).value); });
fillAbout();
keys([
  [' ', 'space', 'pause or go on', togglePlay],
  ['.', '.', 'one frame on', () => step(1)],
  [',', ',', 'one frame back', () => step(-1)],
  ['l', 'L', 'back to now', goLive],
  ['1', '1', 'follow the camera', () => setView('follow')],
  ['2', '2', 'turn freely', () => setView('orbit')],
  ['3', '3', 'from above', () => setView('top')],
  ['f', 'F', 'everything in sight', () => scene?.fit()],
  ['m', 'M', 'distance between two points', () => ruler?.toggle()],
  ['s', 'S', 'save the image of the scene', snapshot],
  ['c', 'C', 'camera picture', () => { picture.hidden = !picture.hidden; }],
  ['p', 'P', 'details', togglePanel],
  ['t', 'T', 'light or dark', () => byId('theme').click()],
  ['?', '?', 'these keys', () => (byId('keys') as HTMLDialogElement).showModal()],
]);
// For tests and debugging.
Object.assign(window, {
  alidade: {
    get state() { return player.shown; },
    get player() { return player; },
    get scene() { return scene; },
    get ruler() { return ruler; },
    project: (p: readonly number[]) => scene?.project(p) ?? null,
    switches,
  },
});
requestAnimationFrame(tick);
void begin();
