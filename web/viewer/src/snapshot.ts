// Saves what the scene shows as a PNG file, with its scale bar.
import type { Scene } from '@alidade/scene';
import { byId, make } from '../../shared/src/dom.ts';
import type { Ruler } from './ruler.ts';

export async function saveImage(scene: Scene, ruler: Ruler, name: string): Promise<void> {
  const { width, height, clientWidth } = byId('scene') as HTMLCanvasElement;
  const canvas = make('canvas');
  canvas.width = width;
  canvas.height = height;
  const draw = canvas.getContext('2d')!;
  scene.copy(draw);
  const style = getComputedStyle(document.documentElement);
  ruler.paint(draw, width / clientWidth, style.getPropertyValue('--ink'), style.getPropertyValue('--page'));
  const blob = await new Promise<Blob | null>((resolve) => { canvas.toBlob(resolve, 'image/png'); });
  if (!blob) throw new Error('the browser made no image');
  const link = make('a');
  link.href = URL.createObjectURL(blob);
  link.download = `${name.replace(/\/+$/, '').split('/').pop()!.replace(/[^\w.-]+/g, '-') || 'map'}.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60e3);
}
