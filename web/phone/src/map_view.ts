// The map in 3D: the viewer's scene, updated at a limited rate to save the phone's CPU time.
import { NoWebGL, Scene } from '@alidade/scene';
import type { State, ViewMode } from '@alidade/scene';
import { sceneColours } from '../../shared/src/colours.ts';
import { byId } from '../../shared/src/dom.ts';

const LEAST = 100; // milliseconds between two updates

export class MapView {
  readonly scene: Scene | null;
  private due = 0;
  private timer = 0;

  constructor(private readonly state: () => State) {
    this.scene = make();
    const system = matchMedia('(prefers-color-scheme: dark)');
    const theme = () => {
      document.documentElement.dataset.theme = system.matches ? 'dark' : 'light';
      this.scene?.colours(sceneColours());
    };
    system.addEventListener('change', theme);
    theme();
    if (!this.scene) return;
    new ResizeObserver(() => this.scene!.resize()).observe(byId('scene'));
    for (const button of document.querySelectorAll<HTMLElement>('[data-view]')) {
      button.addEventListener('click', () => {
        this.scene!.setMode(button.dataset.view as ViewMode);
        for (const other of document.querySelectorAll('[data-view]')) other.setAttribute('aria-pressed', String(other === button));
      });
    }
  }

  changed(): void {
    if (!this.scene || this.timer) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      this.due = performance.now() + LEAST;
      this.scene!.update(this.state());
    }, Math.max(0, this.due - performance.now()));
  }

  forget(): void { this.scene?.forget(); }
}

function make(): Scene | null {
  try {
    return new Scene(byId('scene') as HTMLCanvasElement);
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    document.body.classList.add('no-webgl');
    return null;
  }
}
