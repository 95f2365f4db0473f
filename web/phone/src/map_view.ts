// The map in 3D: the viewer's scene, updated at a limited rate to save the phone's CPU time.
import type { Scene, State, ViewMode } from '@alidade/scene';
import { sceneColours } from '../../shared/src/colours.ts';
import { byId } from '../../shared/src/dom.ts';

const LEAST = 100; // milliseconds between two updates

export class MapView {
  scene: Scene | null = null; // null: not loaded yet, or there is no WebGL
  private mode: ViewMode = 'follow';
  private due = 0;
  private timer = 0;

  constructor(private readonly state: () => State) {
    const system = matchMedia('(prefers-color-scheme: dark)');
    const theme = () => {
      document.documentElement.dataset.theme = system.matches ? 'dark' : 'light';
      this.scene?.colours(sceneColours());
    };
    system.addEventListener('change', theme);
    theme();
    for (const button of document.querySelectorAll<HTMLElement>('[data-view]')) {
      button.addEventListener('click', () => {
        this.mode = button.dataset.view as ViewMode;
        this.scene?.setMode(this.mode);
        for (const other of document.querySelectorAll('[data-view]')) other.setAttribute('aria-pressed', String(other === button));
      });
    }
  }

  // Loads the scene's script and creates the scene. Throws an Error with a sentence for users if one of them fails.
  async load(): Promise<void> {
    const address = new URL('scene3d.js', document.baseURI).href;
    let why = 'The script of the map could not be loaded';
    try {
      const { Scene } = await import(address) as typeof import('./scene3d.ts');
      why = 'This browser cannot show 3D';
      this.scene = new Scene(byId('scene') as HTMLCanvasElement);
    } catch (error) {
      document.body.classList.add('no-webgl');
      throw new Error(`${why}: the map is missing, image and numbers are shown.`, { cause: error });
    }
    this.scene.colours(sceneColours());
    if (this.mode !== 'follow') this.scene.setMode(this.mode);
    new ResizeObserver(() => this.scene!.resize()).observe(byId('scene'));
    this.changed();
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
