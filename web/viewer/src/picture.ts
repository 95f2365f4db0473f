// The camera image with features, detections and outlines.
import { marks, USES } from '@alidade/scene';
import type { Frame, State } from '@alidade/scene';
import { byId, write } from '../../shared/src/dom.ts';

const kPictureSeconds = 1; // seconds; programs send about ten images per second
const MARKS = [...USES, 'things'] as const;
type Mark = (typeof MARKS)[number];

export class Picture {
  private readonly section = byId('picture');
  private readonly canvas = byId('picture-canvas') as HTMLCanvasElement;
  private readonly none = byId('picture-none');
  private readonly counts = MARKS.map((mark) => byId('use-' + mark));
  private readonly visible = new Set<Mark>(MARKS);
  private image: ImageBitmap | null = null;
  private imageOf: Frame | null = null; // the frame whose image is shown
  private decoding: Frame | null = null;
  private wanted: Frame | null = null;
  private shown: { frame: Frame | null; width: number; height: number } | null = null;

  constructor() {
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.movable();
    for (const button of document.querySelectorAll<HTMLElement>('[data-mark]')) {
      button.addEventListener('click', () => this.show(button.dataset.mark as Mark, button.getAttribute('aria-pressed') !== 'true'));
    }
  }

  // Shows or hides one kind of mark.
  show(mark: Mark, visible: boolean): void {
    if (visible) this.visible.add(mark);
    else this.visible.delete(mark);
    document.querySelector(`[data-mark=${mark}]`)!.setAttribute('aria-pressed', String(visible));
    this.draw();
  }

  get hidden(): boolean { return this.section.classList.contains('hidden'); }
  set hidden(hidden: boolean) {
    this.section.classList.toggle('hidden', hidden);
    if (!hidden) this.draw();
  }

  update(state: State): void {
    // The latest image with its own features; without recent images the latest frame's features.
    const { pictured } = state;
    const since = pictured && state.frame ? state.frame.time - pictured.time : -1;
    const frame = since >= 0 && since < kPictureSeconds ? pictured : state.frame;
    const camera = state.hello?.camera;
    const width = camera?.width || frame?.picture?.width || 4;
    const height = camera?.height || frame?.picture?.height || 3;
    if (this.shown?.frame === frame && this.shown?.width === width) return;
    this.shown = { frame, width, height };
    const counts = MARKS.map(() => 0);
    if (frame) for (let at = 4; at < frame.features.length; at += 6) if (frame.features[at] < USES.length) ++counts[frame.features[at]];
    counts[USES.length] = frame?.detections.length ?? 0;
    this.counts.forEach((element, mark) => write(element, String(counts[mark])));
    const age = frame?.detectionAge ?? -1;
    write(byId('things-age'), frame && frame.detections.length > 0 && age > marks.OLD ? `${age.toFixed(1)} s ago` : '');
    if (age >= 0) document.querySelector<HTMLElement>('[data-mark=things]')!.hidden = false; // a detector is running
    if (frame?.picture) void this.decode(frame);
    else this.draw();
  }

  reset(): void {
    this.image?.close();
    this.image = null;
    this.imageOf = null;
    this.wanted = null;
    this.shown = null;
  }

  // Clears everything for another run.
  forget(): void {
    this.reset();
    this.canvas.getContext('2d')!.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.counts.forEach((element) => write(element, '0'));
    document.querySelector<HTMLElement>('[data-mark=things]')!.hidden = true;
  }

  // Decodes one image at a time and skips to the latest. An image is shown with the features of its own frame.
  private async decode(frame: Frame): Promise<void> {
    this.wanted = frame;
    if (this.decoding) return;
    while (this.wanted && this.wanted !== this.imageOf) {
      const next: Frame = this.wanted;
      this.decoding = next;
      try {
        const { bytes, type } = next.picture!;
        const image = await createImageBitmap(new Blob([bytes], { type }));
        if (this.wanted === null) { // cleared meanwhile
          image.close();
          break;
        }
        this.image?.close();
        this.image = image;
        this.imageOf = next;
      } catch {
        this.imageOf = next; // cannot be decoded: show the features only
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
    const on: marks.Canvas = { draw, w, h, ratio, colour: (name) => style.getPropertyValue(name) };
    if (this.visible.has('moving')) marks.outlines(on, frame);
    marks.features(on, frame, this.visible);
    if (this.visible.has('things')) marks.boxes(on, frame, width, height);
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
