// Processing time of each stage over the last frames, in milliseconds.
import uPlot from 'uplot';
import { STAGES } from '@alidade/scene';
import { byId, make } from '../../shared/src/dom.ts';
import type { Player } from './player.ts';

const FRAMES = 240;
// Lines for stages that run on every frame, dots for the others.
const SERIES: { stage: number; colour: string; dots: boolean }[] = [
  { stage: 0, colour: '--ink', dots: false }, { stage: 1, colour: '--path', dots: false }, { stage: 2, colour: '--matched', dots: false },
  { stage: 3, colour: '--fresh', dots: true }, { stage: 4, colour: '--truth', dots: true }, { stage: 5, colour: '--soft', dots: true },
  { stage: 6, colour: '--moving', dots: true }, { stage: 7, colour: '--loop', dots: true },
];

export class Plot {
  private readonly place = byId('plot');
  private chart: uPlot | null = null;
  private frames: { number: number; ms: readonly number[] }[] = [];
  private shown = '';
  private dirty = false;

  constructor() {
    new ResizeObserver(() => this.make()).observe(this.place);
  }

  // The player's frames up to the one shown.
  update(player: Player): void {
    const { frames } = player.history;
    const end = frames.length > 0 ? player.frame() + 1 : 0;
    const key = `${frames.length > 0 ? frames[end - 1].number : -1} ${end}`;
    if (key === this.shown) return;
    this.shown = key;
    this.frames = frames.slice(Math.max(0, end - FRAMES), end);
    this.dirty = true;
  }

  // Clears everything for another run.
  forget(): void {
    this.frames = [];
    this.shown = '';
    this.dirty = true;
  }

  // Recreates the chart, for example after a change of the theme.
  make(): void {
    const width = this.place.clientWidth;
    if (!width) return;
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    this.chart?.destroy();
    const legend = byId('plot-legend');
    legend.replaceChildren();
    const series: uPlot.Series[] = [{}];
    for (const { stage, colour: name, dots } of SERIES) {
      series.push({
        label: STAGES[stage], stroke: colour(name), width: dots ? 0 : stage === 0 ? 1.5 : 1,
        paths: dots ? () => null : undefined,
        points: dots ? { show: true, size: 4, fill: colour(name), stroke: colour(name) } : { show: false },
      });
      const item = make('li');
      item.append(make('i', '', `swatch ${dots ? 'dots' : 'line'} of${name}`), STAGES[stage]);
      legend.append(item);
    }
    const axis = { stroke: colour('--soft'), font: '11px system-ui, sans-serif', grid: { stroke: colour('--line'), width: 1 }, ticks: { show: false } };
    this.chart = new uPlot({
      width, height: 110, series, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false }, y: { range: (_, __, most) => [0, nice(Number.isFinite(most) ? most : 10)] } },
      axes: [{ ...axis, size: 18, gap: 2, grid: { show: false }, values: (_, ticks) => ticks.map(String) }, { ...axis, size: widthOf, gap: 2 }],
    }, [[0], ...SERIES.map(() => [null])] as uPlot.AlignedData, this.place);
    this.dirty = true;
    this.draw();
  }

  draw(): void {
    if (!this.dirty || !this.chart || !this.place.clientWidth) return;
    this.dirty = false;
    const { frames } = this;
    const value = (ms: number | undefined) => (ms === undefined || !(ms >= 0) ? null : ms);
    this.chart.setData([frames.map((f) => f.number), ...SERIES.map(({ stage }) => frames.map((f) => value(f.ms[stage])))] as uPlot.AlignedData);
  }
}

// Rounds up to 1, 2 or 5 times a power of ten, so that the axis rarely changes.
function nice(most: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(1, most)));
  return [1, 2, 5, 10].map((k) => k * power).find((end) => end >= most) ?? most;
}

// Width of an axis with these labels, pixels.
function widthOf(_: uPlot, labels: string[] | null): number {
  return Math.max(30, 10 + 7 * Math.max(0, ...(labels ?? []).map((label) => label.length)));
}
