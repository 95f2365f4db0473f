// The phone page. Data goes one way: camera or video → engine (core.wasm in a Worker, or another computer) → messages →
// PageState → PageView.
import { byId, write } from '../../shared/src/dom.ts';
import { Control } from './control.ts';
import { DetectorHost } from './detector.ts';
import { PageState } from './page_state.ts';
import type { Info, PageMessage } from './page_state.ts';
import { PageView } from './page_view.ts';
import type { Done } from './protocol.ts';
import { pixelsOf } from './ruler.ts';
import { bind, load } from './settings.ts';

declare const BUNDLED: readonly { name: string; version: string; licence: string }[];
declare const PROGRAM: string;

async function serverInfo(): Promise<Info> {
  try {
    const answer = await fetch('info.json' + location.search);
    if (answer.ok) return await answer.json() as Info;
  } catch {
    // offline, or a static file server: the core runs in the page
  }
  return {};
}

const told = serverInfo(); // asked at once: the page waits for it
const choices = load();
const state = new PageState(choices);
const view = new PageView(state);
const watching: { hook: ((done: Done) => void) | null } = { hook: null }; // for tests
const dispatch = (message: PageMessage) => {
  state.apply(message);
  view.update();
  if (message.kind === 'done') watching.hook?.(message.done);
};
const detector = new DetectorHost(choices, (text) => dispatch({ kind: 'notice', about: 'detector', text }));
const asked = told.then((info) => dispatch({ kind: 'info', info }));
const control = new Control(state, dispatch, byId('video') as HTMLVideoElement, detector, asked);

document.addEventListener('visibilitychange', () => { if (document.visibilityState === 'visible') control.resume(); });
byId('start').addEventListener('click', () => void control.startCamera());
byId('stop').addEventListener('click', () => control.end(''));
byId('again').addEventListener('click', () => control.again());
byId('file').addEventListener('change', (event) => {
  const input = event.target as HTMLInputElement;
  const chosen = input.files?.[0];
  input.value = '';
  if (chosen) void control.openFile(chosen);
});
document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', (event) => {
  event.preventDefault();
  const chosen = event.dataTransfer?.files[0];
  if (chosen) void control.openFile(chosen);
});
byId('picture').addEventListener('pointerup', (event) => control.tap(view.at(event)));
byId('remove').addEventListener('click', () => dispatch({ kind: 'cube', cube: null }));
byId('measure').addEventListener('click', () => control.toggleRuler());
byId('record').addEventListener('click', () => control.toggleRecording());
byId('save-open').addEventListener('click', () => control.save());
byId('settings-open').addEventListener('click', () => (byId('settings') as HTMLDialogElement).showModal());
bind(choices, () => dispatch({ kind: 'choices', choices }));
write(byId('about'), `${PROGRAM}. Built with ${BUNDLED.map(({ name, version, licence }) => `${name} ${version} (${licence})`).join(', ')}.`);

// The core is loaded before it is needed; the scene, and the files for working offline, once the page is shown.
async function later(): Promise<void> {
  control.prepare();
  await new Promise((resolve) => { requestAnimationFrame(() => setTimeout(resolve)); });
  view.map.load().catch((error: Error) => dispatch({ kind: 'notice', about: 'webgl', text: error.message }));
  if ('serviceWorker' in navigator && isSecureContext) keepOffline();
}
void asked.then(later);

function keepOffline(): void {
  void navigator.serviceWorker.register('sw.js' + location.search).then(({ installing, waiting, active }) => {
    document.body.dataset.offline = active ? 'ready' : 'soon';
    (installing ?? waiting)?.addEventListener('statechange', function changed() { if (this.state === 'activated') document.body.dataset.offline = 'ready'; });
  }).catch(() => {}); // then the page does not work offline
}

// For tests and debugging.
Object.assign(window, {
  phone: {
    get state() { return state.map; },
    get engine() { return control.engine; },
    get cube() { return state.cube; },
    get measured() { return state.measured; },
    // Pixels of the ruler's ends in the latest image.
    get ends() { return state.ruler ? pixelsOf(state.map, state.ruler.positions(state.map) ?? []) : []; },
    get shown() { return state.shown; },
    get scene() { return view.map.scene; },
    get counters() { return state.counters; },
    detector,
    watch(hook: (done: Done) => void) { watching.hook = hook; },
  },
});
