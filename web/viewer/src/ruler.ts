// The scale bar, and the distance between two points that the user clicks.
import type { Scene } from '@alidade/scene';
import { byId, write } from '../../shared/src/dom.ts';
import { lengthText, roundLength, roundText } from './lengths.ts';

const MOST = 140; // CSS pixels of the scale bar
const STILL = 5; // CSS pixels: a pointer that moved farther has turned the view

type Point = readonly [number, number, number];

export class Ruler {
  active = false;
  private points: Point[] = [];
  private down: { x: number; y: number } | null = null;

  // `say`: shows a text for users; '': removes it.
  constructor(private readonly scene: Scene, private readonly unit: () => string, private readonly say: (text: string) => void) {
    const canvas = byId('scene');
    canvas.addEventListener('pointerdown', ({ clientX, clientY }) => { this.down = { x: clientX, y: clientY }; });
    canvas.addEventListener('pointerup', ({ clientX, clientY }) => {
      const still = this.down && Math.hypot(clientX - this.down.x, clientY - this.down.y) <= STILL;
      if (!this.active || !still) return;
      const { left, top } = canvas.getBoundingClientRect();
      this.click(clientX - left, clientY - top);
    });
    scene.drew = () => this.draw();
  }

  toggle(): void {
    this.active = !this.active;
    this.points = [];
    byId('measure').setAttribute('aria-pressed', String(this.active));
    document.body.classList.toggle('measuring', this.active);
    this.say(this.active ? 'Click two points of the map.' : '');
    this.draw();
  }

  // Null unless two points are chosen.
  get distance(): number | null {
    const [a, b] = this.points;
    return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) : null;
  }

  // Draws bar and measured line into an image of the scene, for saving it.
  paint(onto: CanvasRenderingContext2D, ratio: number, ink: string, ground: string): void {
    const { height } = onto.canvas;
    onto.save();
    onto.scale(ratio, ratio);
    onto.font = '14px system-ui, sans-serif';
    onto.lineWidth = 2;
    const text = (words: string, x: number, y: number) => {
      onto.strokeStyle = ground;
      onto.lineWidth = 4;
      onto.strokeText(words, x, y);
      onto.fillStyle = ink;
      onto.fillText(words, x, y);
    };
    const line = (x1: number, y1: number, x2: number, y2: number) => {
      for (const [style, width] of [[ground, 5], [ink, 2]] as const) {
        onto.strokeStyle = style;
        onto.lineWidth = width;
        onto.beginPath();
        onto.moveTo(x1, y1);
        onto.lineTo(x2, y2);
        onto.stroke();
      }
    };
    const bar = this.bar();
    const base = height / ratio - 16;
    if (bar) {
      line(16, base, 16 + bar.pixels, base);
      text(bar.text, 16, base - 8);
    }
    const [a, b] = this.points.map((p) => this.scene.project(p));
    if (a && b) {
      line(a.x, a.y, b.x, b.y);
      text(lengthText(this.distance!, this.unit()), (a.x + b.x) / 2 + 8, (a.y + b.y) / 2 - 8);
    }
    onto.restore();
  }

  draw(): void {
    const bar = this.bar();
    byId('scale').hidden = !bar;
    if (bar) {
      byId('scale-bar').style.width = `${bar.pixels}px`;
      write(byId('scale-text'), bar.text);
    }
    const ends = this.points.map((p) => this.scene.project(p));
    [byId('measure-a'), byId('measure-b')].forEach((mark, i) => {
      const at = ends[i];
      mark.toggleAttribute('hidden', !at);
      mark.setAttribute('cx', String(at?.x ?? 0));
      mark.setAttribute('cy', String(at?.y ?? 0));
    });
    const [a, b] = ends;
    const line = byId('measure-line');
    line.toggleAttribute('hidden', !(a && b));
    const label = byId('measured');
    label.hidden = !(a && b);
    if (!a || !b) return;
    for (const [name, value] of Object.entries({ x1: a.x, y1: a.y, x2: b.x, y2: b.y })) line.setAttribute(name, String(value));
    write(label, lengthText(this.distance!, this.unit()));
    const { left, top } = byId('scene').getBoundingClientRect();
    label.style.left = `${left + (a.x + b.x) / 2}px`;
    label.style.top = `${top + (a.y + b.y) / 2}px`;
  }

  private click(x: number, y: number): void {
    const point = this.scene.pick(x, y);
    if (!point) return this.say('There is no point there. Click two points of the map.');
    this.points = [...(this.points.length < 2 ? this.points : []), point];
    this.say(this.points.length === 1 ? 'Click the second point.' : '');
    this.draw();
  }

  private bar(): { pixels: number; text: string } | null {
    const pixels = this.scene.pixelsPerUnit;
    if (!(pixels > 0) || !Number.isFinite(pixels) || !this.unit()) return null;
    const length = roundLength(MOST / pixels);
    return { pixels: length * pixels, text: roundText(length, this.unit()) };
  }
}
