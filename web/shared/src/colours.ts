// The colors of the 3D scene, from palette.css.
import type { Colours } from '@alidade/scene';

export function sceneColours(): Colours {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string) => style.getPropertyValue(name).trim();
  return {
    page: of('--space'), ink: of('--ink'), soft: of('--soft'), path: of('--path'), dot: of('--dot'), loop: of('--loop'), truth: of('--truth'),
    camera: of('--fresh'), worst: of('--lost'),
  };
}
