// Counts, state in words, the run, events.
import { LAYERS } from '@alidade/scene';
import type { LayerName, State } from '@alidade/scene';
import { byId, make, write } from './dom.ts';
import type { Player } from './player.ts';
import { clock, EVENT_WORDS, stateReason, stateWord } from './words.ts';

const LAYER_WORDS: Record<LayerName, string> = {
  path: 'Path', keyframes: 'Keyframes', landmarks: 'Landmarks', cloud: 'Depth', covisibility: 'Seen together', loops: 'Loops',
  truth: 'Truth', camera: 'Camera',
};
const EVENTS_SHOWN = 200;

export class Panel {
  private readonly counts = (['keyframes', 'landmarks', 'matches', 'frames'] as const).map(
    (name) => [name, document.querySelector(`[data-count=${name}]`)!] as const);
  private listed = 0;

  constructor(private readonly player: () => Player, private readonly seek: (number: number) => void) {}

  update(state: State): void {
    const { frame, hello } = state;
    const numbers = {
      keyframes: frame?.keyframes ?? state.keyframes.size, landmarks: frame?.landmarks ?? state.landmarks.size,
      matches: frame?.matches ?? 0, frames: frame ? frame.number + 1 : 0,
    };
    for (const [name, element] of this.counts) write(element, String(numbers[name]));
    const word = frame ? stateWord(frame) : 'Waiting';
    const name = frame?.state ?? 'initialising';
    if (document.body.dataset.state !== name) document.body.dataset.state = name;
    write(byId('state-word'), word);
    write(byId('state-reason'), frame ? stateReason(frame) : 'for the first frame');
    write(byId('source'), hello?.source ?? '');
    const sensors: Record<string, string> = { mono: 'one camera', stereo: 'stereo pair', rgbd: 'RGB-D camera' };
    const maps = frame && frame.maps > 1 ? `${frame.maps} maps` : '';
    write(byId('about-run'), hello ? [sensors[hello.sensor] ?? hello.sensor, `lengths in ${hello.unit === 'm' ? 'metres' : hello.unit}`, maps]
      .filter(Boolean).join(' · ') : '');
    if (hello) write(byId('about-program'), hello.program);
    this.listEvents();
  }

  reset(): void {
    this.listed = 0;
    byId('events').replaceChildren();
  }

  private listEvents(): void {
    const { events } = this.player().history;
    const list = byId('events');
    for (; this.listed < events.length; ++this.listed) {
      const { event } = events[this.listed];
      const first = this.player().latest.path.length > 0 ? this.player().latest.path.at(0).time : event.time;
      const button = make('button');
      button.type = 'button';
      button.className = `event ${event.what}`;
      button.append(make('time', clock(event.time - first)), make('span', `${EVENT_WORDS[event.what]}${event.text ? ': ' + event.text : ''}`));
      button.addEventListener('click', () => this.seek(event.number));
      const item = make('li');
      item.append(button);
      list.prepend(item);
      while (list.children.length > EVENTS_SHOWN) list.lastChild!.remove();
    }
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
