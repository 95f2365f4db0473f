// Panel: counts, state, run description, events.
import { LAYERS } from '@alidade/scene';
import type { Alignment, Event, LayerName, State } from '@alidade/scene';
import { byId, make, write } from '../../shared/src/dom.ts';
import { STATE_WORDS } from '../../shared/src/words.ts';
import type { Player } from './player.ts';
import { clock, endText, eventText, reasonText } from './words.ts';

const LAYER_WORDS: Record<LayerName, string> = {
  path: 'Path', keyframes: 'Keyframes', landmarks: 'Landmarks', cloud: 'Depth', covisibility: 'Covisibility', loops: 'Loops',
  truth: 'Truth', camera: 'Camera', others: 'Other maps',
};
const EVENTS_SHOWN = 200;

export class Panel {
  private readonly counts = (['keyframes', 'landmarks', 'matches', 'frames'] as const).map(
    (name) => [name, document.querySelector(`[data-count=${name}]`)!] as const);
  private listed = 0;
  private newest: Event | undefined;

  constructor(private readonly player: () => Player, private readonly seek: (number: number) => void) {}

  update(state: State): void {
    const { frame, hello } = state;
    const { latest } = state;
    // Null: joined late and no frame has arrived yet.
    const now = frame && frame.number === latest?.number ? frame : null;
    const numbers = {
      keyframes: now?.keyframes ?? state.keyframes.size, landmarks: now?.landmarks ?? state.landmarks.size,
      matches: now?.matches ?? 0, frames: latest ? latest.number + 1 : 0,
    };
    for (const [name, element] of this.counts) write(element, String(numbers[name]));
    const name = latest?.state ?? 'initializing';
    if (document.body.dataset.state !== name) document.body.dataset.state = name;
    const over = state.playback?.finished ? endText(state) : null;
    document.body.classList.toggle('ended', over !== null);
    write(byId('state-word'), over?.word ?? (latest ? STATE_WORDS[name] : 'Waiting'));
    write(byId('state-reason'), over?.reason ?? (!latest ? 'for the first frame' : now ? reasonText(now) : ''));
    write(byId('source'), hello?.source ?? '');
    const sensors: Record<string, string> = { mono: 'one camera', stereo: 'stereo pair', rgbd: 'RGB-D camera' };
    const maps = frame && frame.maps > 1 ? `${frame.maps} maps` : '';
    write(byId('about-run'), hello ? [sensors[hello.sensor] ?? hello.sensor, `lengths in ${state.unit === 'm' ? 'meters' : state.unit}`, maps]
      .filter(Boolean).join(' · ') : '');
    if (hello) write(byId('about-program'), hello.program);
    this.listEvents();
  }

  reset(): void {
    this.listed = 0;
    byId('events').replaceChildren();
  }

  // Error of the path relative to the ground truth, if known.
  error(alignment: Alignment | null, state: State): void {
    const metres = (value: number) => (value < 1 ? `${(100 * value).toFixed(1)} cm` : `${value.toFixed(2)} m`);
    const scaled = state.unit !== 'm' ? ', scale fitted' : '';
    write(byId('error'), alignment ? `From the truth: ${metres(alignment.rmse)} RMSE, at most ${metres(alignment.worst)}${scaled}` : '');
  }

  // Newest first. Events are rare, so the list is rebuilt when one is added.
  private listEvents(): void {
    const { events } = this.player().history;
    const { path } = this.player().latest;
    const newest = events[events.length - 1];
    if (this.listed === events.length && this.newest === newest) return;
    this.listed = events.length;
    this.newest = newest;
    const first = path.length > 0 ? path.at(0).time : 0;
    byId('events').replaceChildren(...events.slice(-EVENTS_SHOWN).reverse().map((event) => {
      const button = make('button', '', `event ${event.what}`);
      button.type = 'button';
      button.append(make('time', clock(event.time - first)), make('span', eventText(event)));
      button.addEventListener('click', () => this.seek(event.number));
      const item = make('li');
      item.append(button);
      return item;
    }));
  }
}

export function layerSwitches(change: (layer: LayerName, visible: boolean) => void): Map<LayerName, HTMLInputElement> {
  const boxes = new Map<LayerName, HTMLInputElement>();
  for (const name of LAYERS) {
    const label = make('label');
    const box = make('input');
    box.type = 'checkbox';
    box.checked = name !== 'covisibility';
    box.dataset.layer = name;
    box.addEventListener('change', () => change(name, box.checked));
    label.append(box, make('i', '', `swatch of-layer-${name}`), LAYER_WORDS[name]);
    byId('layers').append(label);
    boxes.set(name, box);
  }
  for (const [name, box] of boxes) change(name, box.checked);
  return boxes;
}
