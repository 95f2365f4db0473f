// Draws marks over a camera image: features, outlines of moving parts, detections.
import { USES } from './messages.ts';
import type { Frame } from './messages.ts';

export interface Canvas {
  draw: CanvasRenderingContext2D;
  w: number; h: number; // size of the canvas in pixels
  ratio: number; // canvas pixels per CSS pixel
  colour(name: string): string;
}

// Kinds differ in shape as well as in color: tracked squares, new rings, unused dots, excluded crosses.
export function features({ draw, w, h, ratio, colour }: Canvas, frame: Frame, visible: ReadonlySet<string>): void {
  const { features: packed } = frame;
  const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
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
    if (!visible.has(use)) return;
    draw.beginPath();
    for (let at = 0; at + 6 <= packed.length; at += 6) {
      if (packed[at + 4] === number) forms[number]((view.getUint16(at, true) * w) / 65536, (view.getUint16(at + 2, true) * h) / 65536);
    }
    draw.lineWidth = 3 * ratio;
    draw.strokeStyle = 'rgba(0,0,0,.45)';
    if (use !== 'free') draw.stroke();
    draw.lineWidth = 1.4 * ratio;
    draw.strokeStyle = colour(`--${use}`);
    draw.stroke();
  });
}

// Outlines of the excluded parts; a polygon inside another one is a hole.
export function outlines({ draw, w, h, ratio, colour }: Canvas, frame: Frame): void {
  if (frame.outlines.length === 0) return;
  draw.beginPath();
  for (const points of frame.outlines) {
    for (let i = 0; i + 1 < points.length; i += 2) {
      const [x, y] = [(points[i] * w) / 65536, (points[i + 1] * h) / 65536];
      if (i === 0) draw.moveTo(x, y);
      else draw.lineTo(x, y);
    }
    draw.closePath();
  }
  draw.globalAlpha = 0.25;
  draw.fillStyle = colour('--moving');
  draw.fill('evenodd');
  draw.globalAlpha = 1;
  draw.lineWidth = 1.2 * ratio;
  draw.strokeStyle = colour('--moving');
  draw.stroke();
}

export const OLD = 0.1; // seconds: older boxes are dashed

// `width`, `height`: size of the camera image, pixels.
export function boxes({ draw, w, h, ratio, colour }: Canvas, frame: Frame, width: number, height: number): void {
  const old = frame.detectionAge > OLD;
  draw.font = `${11 * ratio}px system-ui, sans-serif`;
  for (const box of [...frame.detections].reverse()) { // the best last, on top of the others
    const [x, y] = [(box.x * w) / width, (box.y * h) / height];
    const size = [(box.width * w) / width, (box.height * h) / height] as const;
    draw.setLineDash(old ? [5 * ratio, 3 * ratio] : []);
    draw.lineWidth = 3.5 * ratio;
    draw.strokeStyle = 'rgba(0,0,0,.55)';
    draw.strokeRect(x, y, ...size);
    draw.lineWidth = 1.5 * ratio;
    draw.strokeStyle = colour('--things');
    draw.strokeRect(x, y, ...size);
    const text = `${box.label} ${Math.round(100 * box.score)} %`;
    const long = draw.measureText(text).width + 8 * ratio;
    const left = Math.max(0, Math.min(x, w - long));
    const top = Math.max(0, y - 15 * ratio);
    draw.fillStyle = colour('--things');
    draw.fillRect(left, top, long, 15 * ratio);
    draw.fillStyle = '#14171b';
    draw.fillText(text, left + 4 * ratio, top + 11 * ratio);
  }
  draw.setLineDash([]);
}
