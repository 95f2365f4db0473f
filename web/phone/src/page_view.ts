// Draws the page's state: texts and numbers, the image, the map. Keeps nothing but what was drawn last.
import type { State } from '@alidade/scene';
import { byId, write } from '../../shared/src/dom.ts';
import { pathText } from './lengths.ts';
import type { Point } from './lens.ts';
import { MapView } from './map_view.ts';
import type { PageState } from './page_state.ts';
import { PictureView } from './picture.ts';
import { lensText, statusOf, whereText } from './words.ts';

export class PageView {
  readonly map: MapView;
  private readonly picture = new PictureView();
  private drawn = -1; // revision
  private drawnMap: State;

  constructor(private readonly state: PageState) {
    this.drawnMap = state.map;
    this.map = new MapView(() => state.map);
  }

  // Pixel of the stream's camera at the tap; null: outside the image.
  at(event: PointerEvent): Point | null { return this.picture.at(event, this.state.map); }

  update(): void {
    const { state } = this;
    this.texts();
    this.numbers();
    if (state.revision === this.drawn) return;
    this.drawn = state.revision;
    if (state.shown?.bitmap) this.picture.show(state);
    if (this.drawnMap !== state.map) this.map.forget();
    this.drawnMap = state.map;
    this.map.changed();
  }

  private texts(): void {
    const { state } = this;
    const { phase, info, notices, recording, progress } = state;
    document.body.dataset.phase = phase;
    byId('again').hidden = phase !== 'ended';
    byId('save-open').hidden = !state.savable;
    byId('remove').hidden = state.cube === null;
    byId('set-connected-row').hidden = !(info?.connected && info.core !== false);
    write(byId('where'), info ? whereText(state, location.host) : '');
    (byId('file') as HTMLInputElement).disabled = info === null;
    (byId('start') as HTMLButtonElement).disabled = info === null || state.opening;
    const { word, advice } = statusOf(state);
    write(byId('state-word'), word);
    write(byId('advice'), advice);
    byId('measure').hidden = phase !== 'running' || !state.savable;
    byId('measure').setAttribute('aria-pressed', String(state.measuring));
    write(byId('lens'), state.shown ? [pathText(state), lensText(state.shown.frame, state.choices.fov !== null)].filter(Boolean).join(' · ') : '');
    write(byId('record'), recording === null ? 'Record' : `Recording ${recording}`);
    byId('record').setAttribute('aria-pressed', String(recording !== null));
    byId('progress').hidden = progress === null || phase !== 'running';
    (byId('progress-bar') as HTMLProgressElement).value = progress?.duration ? Math.min(1, progress.seconds / progress.duration) : 0;
    write(byId('progress-text'), progress ? `${progress.seconds.toFixed(1)} of ${progress.duration.toFixed(1)} s` : '');
    const all = [...notices.values()].join(' ');
    write(byId('notice'), all);
    byId('notice').hidden = all === '';
  }

  private numbers(): void {
    const { phase, shown, counters } = this.state;
    const { keyframes, landmarks, matches } = shown?.frame.counts ?? { keyframes: 0, landmarks: 0, matches: 0 };
    const numbers = { keyframes, landmarks, matches, frames: counters.processed, milliseconds: Math.round(shown?.frame.milliseconds ?? 0) };
    for (const [name, value] of Object.entries(numbers)) write(document.querySelector(`[data-count=${name}]`)!, String(value));
    document.body.dataset.state = phase === 'ended' ? phase : shown?.frame.state ?? 'initializing';
    document.body.dataset.frames = String(counters.processed);
  }
}
