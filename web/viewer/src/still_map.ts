// A map that is shown without its run: nothing that only a run has is shown, and the page says how to keep it.
import { readPly } from '@alidade/scene';
import type { LayerName, Pose, Scene, State } from '@alidade/scene';
import { byId, write } from '../../shared/src/dom.ts';
import { query } from './connection.ts';

export class StillMap {
  private fitted = false;
  private shape = false;

  constructor(private readonly scene: Scene | null, private readonly switches: ReadonlyMap<LayerName, HTMLInputElement>) {
    document.body.classList.add('still');
    byId('still-note').hidden = false;
    scene?.show('camera', false);
  }

  // The semi-dense cloud beside the map.
  async load(T_world_cloud: Pose): Promise<void> {
    const response = await fetch('semidense.ply' + query());
    if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
    this.scene?.setShape(readPly(new Uint8Array(await response.arrayBuffer())), T_world_cloud);
    this.shape = true;
  }

  // The mesh beside it, instead of the cloud.
  async loadMesh(T_world_mesh: Pose): Promise<void> {
    const response = await fetch('mesh.ply' + query());
    if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
    this.scene?.setSurface(readPly(new Uint8Array(await response.arrayBuffer())), T_world_mesh);
    this.shape = true;
  }

  // `first`: shows the whole map; called once, after the scene was updated.
  update(state: State, first: () => void): void {
    const { keyframes, path, clouds, hello } = state;
    const empty: Partial<Record<LayerName, boolean>> = {
      camera: true, truth: !hello?.truth.length, path: path.length === 0, cloud: !this.shape && clouds.size === 0,
      loops: [...keyframes.values()].every(({ loops }) => loops.length === 0),
    };
    for (const [layer, hidden] of Object.entries(empty)) this.switches.get(layer as LayerName)!.parentElement!.hidden = hidden;
    const has = ['the map', ...(path.length > 0 ? ['the path'] : []), ...(empty.cloud ? [] : ['depth'])];
    write(byId('still-has'), has.length === 1 ? has[0]! : `${has.slice(0, -1).join(', ')} and ${has.at(-1)}`);
    document.querySelector<HTMLElement>('[data-count=frames]')!.parentElement!.hidden = path.length === 0;
    if (this.fitted || keyframes.size === 0) return;
    this.fitted = true;
    first();
  }
}
