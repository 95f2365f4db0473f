// The processed camera image with its features, the cube and the ruler.
import * as marks from '../../scene/src/picture_marks.ts';
import type { State } from '@alidade/scene';
import { byId } from '../../shared/src/dom.ts';
import type { Cube } from './cube.ts';
import { CUBE_EDGE, lengthText } from './lengths.ts';
import type { Point } from './lens.ts';
import type { PageState } from './page_state.ts';
import { pixelsOf } from './ruler.ts';

const MARKS: ReadonlySet<string> = new Set(['matched', 'fresh', 'free', 'moving']);

export class PictureView {
  private readonly canvas = byId('picture') as HTMLCanvasElement;
  private readonly draw = this.canvas.getContext('2d')!;
  private turn = 0;

  // The image shown last. Pixel coordinates refer to the image as oriented at the start; it has been turned by
  // shown.turn clockwise quarter turns since.
  show(page: PageState): void {
    const { canvas, draw } = this;
    const { shown, map: state, choices } = page;
    const { bitmap, turn } = shown!;
    if (!bitmap) return;
    const { frame } = state;
    this.turn = turn;
    if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
      canvas.width = bitmap.width;
      canvas.height = bitmap.height;
    }
    draw.setTransform(1, 0, 0, 1, 0, 0);
    draw.drawImage(bitmap, 0, 0);
    const [w, h] = this.size();
    draw.translate(canvas.width / 2, canvas.height / 2);
    draw.rotate((-turn * Math.PI) / 2);
    draw.translate(-w / 2, -h / 2);
    const style = getComputedStyle(document.documentElement);
    const onto = { draw, w, h, ratio: Math.max(w, h) / 480, colour: (name: string) => style.getPropertyValue(name) };
    const camera = state.hello?.camera;
    if (choices.features && frame) {
      marks.outlines(onto, frame);
      marks.features(onto, frame, MARKS);
      if (camera) marks.boxes(onto, frame, camera.width, camera.height);
    }
    if (page.cube) this.drawCube(page.cube, state, w, h, shown!.inertial?.metric ? CUBE_EDGE : null);
    if (page.ruler) this.drawRuler(page, w, h);
  }

  // Pixel of the stream's camera at the tap; null: outside the image.
  at(event: PointerEvent, state: State): Point | null {
    const camera = state.hello?.camera;
    if (!camera) return null;
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const { width: cw, height: ch } = this.canvas;
    const scale = Math.min(width / cw, height / ch); // object-fit: contain
    // Relative to the center.
    const [x, y] = [(event.clientX - left - width / 2) / scale, (event.clientY - top - height / 2) / scale];
    const [w, h] = this.size();
    const angle = (this.turn * Math.PI) / 2;
    const [u, v] = [x * Math.cos(angle) - y * Math.sin(angle) + w / 2, x * Math.sin(angle) + y * Math.cos(angle) + h / 2];
    if (u < 0 || v < 0 || u > w || v > h) return null;
    return [(u * camera.width) / w - 0.5, (v * camera.height) / h - 0.5];
  }

  // Size of the image as oriented at the start.
  private size(): [number, number] {
    const { width, height } = this.canvas;
    return this.turn % 2 ? [height, width] : [width, height];
  }

  private drawCube(cube: Cube, state: State, w: number, h: number, edge: number | null): void {
    const camera = state.hello?.camera;
    const T_world_camera = state.cameraPose();
    if (!camera || !T_world_camera) return;
    const { draw } = this;
    draw.lineWidth = w / 400;
    draw.lineJoin = 'round';
    for (const { corners, light } of cube.faces(state, T_world_camera, edge)) {
      draw.beginPath();
      corners.forEach(([x, y], i) => draw[i === 0 ? 'moveTo' : 'lineTo'](((x + 0.5) * w) / camera.width, ((y + 0.5) * h) / camera.height));
      draw.closePath();
      draw.fillStyle = `rgb(${230 * light} ${140 * light} ${20 * light})`;
      draw.fill();
      draw.strokeStyle = '#3a2405';
      draw.stroke();
    }
  }

  // Upright on the screen, whatever the turn of the image is.
  private drawRuler(page: PageState, w: number, h: number): void {
    const { draw } = this;
    const { map, ruler, measured } = page;
    const camera = map.hello?.camera;
    if (!camera) return;
    const points = pixelsOf(map, ruler!.positions(map) ?? []).map(([x, y]): Point => [((x + 0.5) * w) / camera.width, ((y + 0.5) * h) / camera.height]);
    const unit = Math.max(w, h) / 320;
    draw.lineCap = 'round';
    for (const [colour, width] of [['rgb(0 0 0 / .7)', 4 * unit], ['#ffd400', 2 * unit]] as const) {
      draw.strokeStyle = colour;
      draw.lineWidth = width;
      draw.beginPath();
      const [a, b] = points;
      if (a && b) {
        draw.moveTo(...a);
        draw.lineTo(...b);
      }
      for (const [x, y] of points) {
        draw.moveTo(x + 5 * unit, y);
        draw.arc(x, y, 5 * unit, 0, 2 * Math.PI);
      }
      draw.stroke();
    }
    const [a, b] = points;
    if (!a || !b || !measured) return;
    draw.save();
    draw.translate((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
    draw.rotate((this.turn * Math.PI) / 2);
    draw.font = `600 ${14 * unit}px system-ui, sans-serif`;
    const words = lengthText(measured);
    const half = draw.measureText(words).width / 2 + 5 * unit;
    draw.fillStyle = 'rgb(0 0 0 / .75)';
    draw.fillRect(-half, -30 * unit, 2 * half, 20 * unit);
    draw.fillStyle = '#fff';
    draw.textAlign = 'center';
    draw.textBaseline = 'middle';
    draw.fillText(words, 0, -20 * unit);
    draw.restore();
  }
}
