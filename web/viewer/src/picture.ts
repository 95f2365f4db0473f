// The camera picture with its features, boxes and outlines.
import { USES } from '@alidade/scene';
import type { Frame, State } from '@alidade/scene';
import { byId } from './dom.ts';

export class Picture {
  private readonly section = byId('picture');
  private readonly canvas = byId('picture-canvas') as HTMLCanvasElement;
  private readonly none = byId('picture-none');
  private readonly uses = USES.map((use) => byId('use-' + use));
  private image: ImageBitmap | null = null;
  private imageOf: Frame | null = null; // whose picture is shown
  private decoding: Frame | null = null;
  private wanted: Frame | null = null;
  private shown: { frame: Frame | null; width: number; height: number } | null = null;

  constructor() {
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.movable();
  }

  get hidden(): boolean { return this.section.classList.contains('hidden'); }
  set hidden(hidden: boolean) {
    this.section.classList.toggle('hidden', hidden);
    if (!hidden) this.draw();
  }

  update(state: State): void {
    const { frame } = state;
    const camera = state.hello?.camera;
    const width = camera?.width || frame?.picture?.width || 4;
    const height = camera?.height || frame?.picture?.height || 3;
    if (this.shown?.frame === frame && this.shown?.width === width) return;
    this.shown = { frame, width, height };
    const counts = USES.map(() => 0);
    if (frame) for (let at = 4; at < frame.features.length; at += 6) if (frame.features[at] < counts.length) ++counts[frame.features[at]];
    this.uses.forEach((element, use) => { element.textContent = String(counts[use]); });
    if (frame?.picture) void this.decode(frame);
    else this.draw();
  }

  reset(): void {
    this.image?.close();
    this.image = null;
    this.imageOf = null;
    this.shown = null;
  }

  // One at a time; of those that come meanwhile only the latest. A picture is shown with the features of its own frame.
  private async decode(frame: Frame): Promise<void> {
    this.wanted = frame;
    if (this.decoding) return;
    while (this.wanted && this.wanted !== this.imageOf) {
      const next: Frame = this.wanted;
      this.decoding = next;
      try {
        const { bytes, type } = next.picture!;
        const image = await createImageBitmap(new Blob([bytes], { type }));
        this.image?.close();
        this.image = image;
        this.imageOf = next;
      } catch {
        this.imageOf = next; // cannot be decoded: features alone
      }
      this.draw();
    }
    this.decoding = null;
  }

  private draw(): void {
    const { canvas } = this;
    if (this.hidden || !canvas.clientWidth || !this.shown) return;
    const { width, height } = this.shown;
    const frame = this.shown.frame?.picture ? this.imageOf : this.shown.frame;
    const ratio = Math.min(2, devicePixelRatio);
    const w = Math.round(canvas.clientWidth * ratio);
    const h = Math.round((w * height) / width);
    if (canvas.width !== w || canvas.height !== h) {
      canvas.width = w;
      canvas.height = h;
    }
    const draw = canvas.getContext('2d')!;
    draw.clearRect(0, 0, w, h);
    const hasPicture = Boolean(frame?.picture && this.image);
    this.none.hidden = hasPicture || frame === null;
    if (!frame) return;
    if (hasPicture) draw.drawImage(this.image!, 0, 0, w, h);
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name);
    this.drawOutlines(draw, frame, w, h, colour('--moving'));
    drawFeatures(draw, frame, w, h, ratio, colour);
    draw.lineWidth = 1.5 * ratio;
    draw.font = `${11 * ratio}px system-ui, sans-serif`;
    for (const box of frame.detections) {
      const [x, y] = [((box.x + 0.5) * w) / width, ((box.y + 0.5) * h) / height];
      draw.strokeStyle = colour('--moving');
      draw.strokeRect(x, y, (box.width * w) / width, (box.height * h) / height);
      const text = `${box.label} ${Math.round(100 * box.score)} %`;
      const long = draw.measureText(text).width + 8 * ratio;
      draw.fillStyle = colour('--moving');
      draw.fillRect(x, Math.max(0, y - 15 * ratio), long, 15 * ratio);
      draw.fillStyle = '#fff';
      draw.fillText(text, x + 4 * ratio, Math.max(11 * ratio, y - 4 * ratio));
    }
  }

  private drawOutlines(draw: CanvasRenderingContext2D, frame: Frame, w: number, h: number, colour: string): void {
    for (const points of frame.outlines) {
      draw.beginPath();
      for (let i = 0; i + 1 < points.length; i += 2) draw.lineTo((points[i] * w) / 65536, (points[i + 1] * h) / 65536);
      draw.closePath();
      draw.globalAlpha = 0.25;
      draw.fillStyle = colour;
      draw.fill();
      draw.globalAlpha = 1;
    }
  }

  private movable(): void {
    const { section } = this;
    const drag = (handle: HTMLElement, begin: () => (dx: number, dy: number) => void) => {
      handle.addEventListener('pointerdown', (down) => {
        if ((down.target as HTMLElement).closest('button')) return;
        const move = begin();
        handle.setPointerCapture(down.pointerId);
        const moved = (event: PointerEvent) => move(event.clientX - down.clientX, event.clientY - down.clientY);
        handle.addEventListener('pointermove', moved);
        const done = () => handle.removeEventListener('pointermove', moved);
        handle.addEventListener('pointerup', done, { once: true });
        handle.addEventListener('pointercancel', done, { once: true });
        down.preventDefault();
      });
    };
    drag(byId('picture-bar'), () => {
      const { left, top, width } = section.getBoundingClientRect();
      return (dx, dy) => {
        section.style.left = `${Math.max(8 - width + 60, Math.min(innerWidth - 60, left + dx))}px`;
        section.style.top = `${Math.max(0, Math.min(innerHeight - 60, top + dy))}px`;
      };
    });
    drag(byId('picture-size'), () => {
      const { width } = section.getBoundingClientRect();
      return (dx) => { section.style.width = `${Math.max(180, Math.min(innerWidth - 40, width + dx))}px`; };
    });
    byId('picture-hide').addEventListener('click', () => { this.hidden = true; });
  }
}

// Told apart by form as well as by colour: tracked are squares, new ones rings, unused ones dots, moving ones crosses.
function drawFeatures(draw: CanvasRenderingContext2D, frame: Frame, w: number, h: number, ratio: number, colour: (name: string) => string): void {
  const { features } = frame;
  const view = new DataView(features.buffer, features.byteOffset, features.byteLength);
  const r = 2 * ratio;
  const forms: ((x: number, y: number) => void)[] = [
    (x, y) => draw.rect(x - ratio / 2, y - ratio / 2, ratio, ratio),
    (x, y) => draw.rect(x - r, y - r, 2 * r, 2 * r),
    (x, y) => {
      draw.moveTo(x + 1.6 * r, y);
      draw.arc(x, y, 1.6 * r, 0, 2 * Math.PI);
    },
    (x, y) => {
      draw.moveTo(x - 1.5 * r, y - 1.5 * r);
      draw.lineTo(x + 1.5 * r, y + 1.5 * r);
      draw.moveTo(x - 1.5 * r, y + 1.5 * r);
      draw.lineTo(x + 1.5 * r, y - 1.5 * r);
    },
  ];
  USES.forEach((use, number) => {
    draw.beginPath();
    for (let at = 0; at + 6 <= features.length; at += 6) {
      if (features[at + 4] === number) forms[number]((view.getUint16(at, true) * w) / 65536, (view.getUint16(at + 2, true) * h) / 65536);
    }
    draw.lineWidth = 3 * ratio;
    draw.strokeStyle = 'rgba(0,0,0,.45)';
    if (use !== 'free') draw.stroke();
    draw.lineWidth = 1.4 * ratio;
    draw.strokeStyle = colour(`--${use}`);
    draw.stroke();
  });
}
