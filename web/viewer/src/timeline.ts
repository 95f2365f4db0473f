// Timeline: the state of each frame, events as marks, and a handle to seek.
import { STATES } from '@alidade/scene';
import type { State } from '@alidade/scene';
import { byId, write } from '../../shared/src/dom.ts';
import type { Player } from './player.ts';
import { clock, eventText } from './words.ts';

const RANK = { tracking: 0, initializing: 1, lost: 2 }; // each pixel shows the worst state of its frames

export class Timeline {
  private readonly canvas = byId('timeline-canvas') as HTMLCanvasElement;
  private readonly input = byId('seek') as HTMLInputElement;
  private readonly tip = byId('tip') as HTMLOutputElement;
  private drawn = '';

  constructor(private readonly player: () => Player, seek: (number: number) => void) {
    this.input.addEventListener('input', () => seek(Number(this.input.value)));
    this.input.addEventListener('pointermove', (event) => this.showTip(event.offsetX));
    this.input.addEventListener('pointerleave', () => { this.tip.hidden = true; });
    new ResizeObserver(() => {
      this.drawn = '';
      this.update();
    }).observe(this.canvas);
  }

  // Redraws, for example after a change of the theme.
  refresh(): void {
    this.drawn = '';
    this.update();
  }

  update(): void {
    const player = this.player();
    const { latest, shown, history } = player;
    const end = this.end();
    const number = shown.latest?.number ?? 0;
    const key = [end, latest.path.length, number, history.events.length, history.first, this.canvas.clientWidth].join();
    if (key === this.drawn) return;
    this.drawn = key;
    this.input.min = '0';
    this.input.max = String(end);
    if (Number(this.input.value) !== number) this.input.value = String(number);
    this.input.setAttribute('aria-valuetext', `frame ${number}, ${clock(this.time(shown))}`);
    write(byId('clock'), clock(this.time(shown)));
    this.draw(latest, end, number);
  }

  private time(state: State): number {
    const first = this.player().latest.path.length > 0 ? this.player().latest.path.at(0).time : 0;
    return (state.latest?.time ?? first) - first;
  }

  // The largest frame number of the axis.
  private end(): number {
    const { latest } = this.player();
    const last = latest.path.length > 0 ? latest.path.at(latest.path.length - 1).number : 0;
    const known = latest.hello?.frames ?? -1;
    return Math.max(1, last, known - 1);
  }

  private draw(latest: State, end: number, number: number): void {
    const { canvas } = this;
    const ratio = Math.min(2, devicePixelRatio);
    const w = Math.round(canvas.clientWidth * ratio);
    const h = Math.round(canvas.clientHeight * ratio);
    if (!w || !h) return;
    if (canvas.width !== w) canvas.width = w;
    if (canvas.height !== h) canvas.height = h;
    const draw = canvas.getContext('2d')!;
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name);
    draw.clearRect(0, 0, w, h);
    const barTop = Math.round(h * 0.5);
    const bar = Math.round(h * 0.3);
    draw.fillStyle = colour('--line');
    draw.fillRect(0, barTop + bar * 0.35, w, bar * 0.3);
    const columns = new Int8Array(w + 1).fill(-1);
    const wide = Math.ceil(w / (end + 1));
    latest.path.states((frame, state) => {
      const x = Math.floor((frame / (end + 1)) * w);
      for (let k = 0; k < wide && x + k <= w; ++k) if (x + k >= 0) columns[x + k] = Math.max(columns[x + k], RANK[STATES[state]]);
    });
    // The bar's height differs too: tracking full, initializing half, lost full with gaps.
    for (let x = 0; x < w; ++x) {
      if (columns[x] < 0) continue;
      if (columns[x] === RANK.tracking) {
        draw.fillStyle = colour('--tracked');
        draw.fillRect(x, barTop, 1, bar);
      } else if (columns[x] === RANK.initializing) {
        draw.fillStyle = colour('--dot');
        draw.fillRect(x, barTop + bar / 4, 1, bar / 2);
      } else if (Math.floor(x / (2 * ratio)) % 2 === 0) {
        draw.fillStyle = colour('--lost');
        draw.fillRect(x, barTop, 1, bar);
      }
    }
    for (const event of this.player().history.events) this.mark(draw, (event.number / (end + 1)) * w, barTop, ratio, event.what, colour);
    const x = ((number + 0.5) / (end + 1)) * w;
    draw.fillStyle = colour('--ink');
    draw.fillRect(Math.round(x - ratio), barTop - bar * 0.45, 2 * ratio, bar * 1.9);
    draw.beginPath();
    draw.arc(x, barTop + bar / 2, 5 * ratio, 0, 2 * Math.PI);
    draw.fill();
  }

  private mark(draw: CanvasRenderingContext2D, x: number, below: number, ratio: number, what: string, colour: (name: string) => string): void {
    const r = 4 * ratio;
    const y = below - 2.2 * r;
    draw.beginPath();
    if (what === 'loop' || what === 'merge') {
      draw.fillStyle = colour('--loop');
      draw.moveTo(x, y - r);
      draw.lineTo(x + r, y);
      draw.lineTo(x, y + r);
      draw.lineTo(x - r, y);
    } else if (what === 'lost' || what === 'warning' || what === 'given_up') {
      draw.fillStyle = colour('--lost');
      draw.moveTo(x - r, y - r);
      draw.lineTo(x + r, y - r);
      draw.lineTo(x, y + r);
    } else if (what === 'found' || what === 'started' || what === 'new_map') {
      draw.fillStyle = colour('--tracked');
      draw.moveTo(x - r, y + r);
      draw.lineTo(x + r, y + r);
      draw.lineTo(x, y - r);
    } else {
      return;
    }
    draw.fill();
  }

  private showTip(x: number): void {
    const { history } = this.player();
    const width = this.canvas.clientWidth;
    let nearest = 8; // CSS pixels
    let text = '';
    for (const event of history.events) {
      const away = Math.abs((event.number / (this.end() + 1)) * width - x);
      if (away < nearest) {
        nearest = away;
        text = eventText(event);
      }
    }
    this.tip.hidden = text === '';
    write(this.tip, text);
    this.tip.style.left = `${Math.max(60, Math.min(width - 60, x))}px`;
  }
}
