// Uploads the layers of a state to GPU buffers; each uploads only what changed since the last drawing.
import type { Anchors } from './anchors.ts';
import { NOWHERE } from './anchors.ts';
import type { LineLayer } from './lines.ts';
import type { Camera, DepthCloud, KeyFrame } from './messages.ts';
import { NONE } from './messages.ts';
import type { Page } from './pages.ts';
import { PAGE } from './pages.ts';
import type { PointLayer } from './points.ts';
import type { State } from './state.ts';

export class LandmarkUpload {
  private drawn: { page: Page; version: number }[] = [];

  constructor(private readonly layer: PointLayer, private readonly anchors: Anchors) {}

  update(state: State): void {
    const { landmarks } = state;
    this.layer.reserve(landmarks.pages.length * PAGE);
    landmarks.pages.forEach((page, number) => {
      const drawn = this.drawn[number];
      if (drawn?.page === page && drawn.version === page.version) return;
      this.drawn[number] = { page, version: page.version };
      const begin = number * PAGE;
      const end = Math.min(begin + PAGE, landmarks.size);
      for (let i = begin; i < end; ++i) {
        const at = 5 * (i - begin);
        this.layer.set(i, this.anchors.slot(page.u32[at + 1]), page.f32[at + 2], page.f32[at + 3], page.f32[at + 4]);
      }
      this.layer.changed(begin, end);
    });
    this.drawn.length = landmarks.pages.length;
    this.layer.count = landmarks.size;
  }
}

const BLOCK = 256; // points

// A keyframe's points are stored in blocks anywhere in the buffer; blocks of removed keyframes are reused.
export class CloudUpload {
  private drawn = new Map<number, { cloud: DepthCloud; blocks: number[] }>();
  private unused: number[] = [];
  private blocks = 0;

  constructor(private readonly layer: PointLayer, private readonly anchors: Anchors) {}

  update(state: State): void {
    const camera = state.hello?.camera;
    if (!camera) return;
    for (const [id, { cloud, blocks }] of this.drawn) {
      if (state.clouds.get(id) === cloud) continue;
      for (const block of blocks) {
        for (let i = 0; i < BLOCK; ++i) this.layer.hide(block * BLOCK + i, NOWHERE);
        this.layer.changed(block * BLOCK, (block + 1) * BLOCK);
      }
      this.unused.push(...blocks);
      this.drawn.delete(id);
    }
    for (const [id, cloud] of state.clouds) if (!this.drawn.has(id)) this.add(id, cloud, camera);
    this.layer.count = this.blocks * BLOCK;
  }

  private add(id: number, cloud: DepthCloud, camera: Camera): void {
    const count = cloud.points.length / 4;
    const slot = this.anchors.slot(id);
    const blocks: number[] = [];
    const span = Math.log(cloud.most / cloud.least) / 65535;
    for (let begin = 0; begin < count; begin += BLOCK) {
      const block = this.unused.pop() ?? this.blocks++;
      blocks.push(block);
      this.layer.reserve(this.blocks * BLOCK);
      for (let i = 0; i < BLOCK; ++i) {
        const at = 4 * (begin + i);
        if (begin + i >= count) {
          this.layer.hide(block * BLOCK + i, NOWHERE);
          continue;
        }
        const z = 1 / (cloud.least * Math.exp(span * cloud.points[at + 2]));
        const u = (cloud.points[at] * camera.width) / 65536 - 0.5;
        const v = (cloud.points[at + 1] * camera.height) / 65536 - 0.5;
        this.layer.set(block * BLOCK + i, slot, (z * (u - camera.cx)) / camera.fx, (z * (v - camera.cy)) / camera.fy, z, cloud.points[at + 3]);
      }
      this.layer.changed(block * BLOCK, (block + 1) * BLOCK);
    }
    this.drawn.set(id, { cloud, blocks });
  }
}

const ORIGIN = [0, 0, 0];

// Image corners at depth 1, times `size`.
export function corners(camera: Camera | null, size: number): number[][] {
  const { width, height, fx, fy, cx, cy } = camera ?? { width: 640, height: 480, fx: 500, fy: 500, cx: 320, cy: 240 };
  const at = (u: number, v: number) => [(size * (u - cx)) / fx, (size * (v - cy)) / fy, size];
  return [at(-0.5, -0.5), at(width - 0.5, -0.5), at(width - 0.5, height - 0.5), at(-0.5, height - 0.5)];
}

function addFrustum(layer: LineLayer, slot: number, of: number[][]): void {
  of.forEach((corner, k) => {
    layer.add(slot, ORIGIN, slot, corner);
    layer.add(slot, corner, slot, of[(k + 1) % 4]);
  });
}

export function drawFrusta(layer: LineLayer, state: State, anchors: Anchors, size: number): void {
  const of = corners(state.hello?.camera ?? null, size);
  layer.begin(8 * state.keyframes.size);
  for (const id of state.keyframes.keys()) addFrustum(layer, anchors.slot(id), of);
  layer.end();
}

// Draws each edge once, although both keyframes list it.
export function drawEdges(layer: LineLayer, state: State, anchors: Anchors, of: (keyframe: KeyFrame) => readonly number[]): void {
  const done = new Set<string>();
  const edges: [number, number][] = [];
  for (const keyframe of state.keyframes.values()) {
    for (const other of of(keyframe)) {
      if (!state.keyframes.has(other)) continue;
      const key = keyframe.id < other ? `${keyframe.id} ${other}` : `${other} ${keyframe.id}`;
      if (done.has(key)) continue;
      done.add(key);
      edges.push([anchors.slot(keyframe.id), anchors.slot(other)]);
    }
  }
  layer.begin(edges.length);
  for (const [a, b] of edges) layer.add(a, ORIGIN, b, ORIGIN);
  layer.end();
}

// Connects consecutive frames that both have a pose. Appends new frames while the map is unchanged.
export class PathUpload {
  private done = 0; // number of frames
  private before: { slot: number; t: number[]; map: number } | null = null;

  constructor(private readonly layer: LineLayer, private readonly anchors: Anchors) {}

  // `tint`: 0…1 at the end of each frame's segment.
  update(state: State, anew: boolean, tint: (i: number) => number): void {
    const { path } = state;
    if (anew || path.length < this.done) {
      this.done = 0;
      this.before = null;
      this.layer.begin(path.length);
    }
    this.layer.reserve(path.length);
    for (; this.done < path.length; ++this.done) {
      const i = this.done;
      const page = path.read(i);
      const at = (i % PAGE) * 20;
      const reference = page.u32[at + 17];
      const keyframe = reference === NONE || page.u32[at + 18] !== 1 ? undefined : state.keyframes.get(reference);
      if (!keyframe) {
        this.before = null;
        continue;
      }
      const t = page.f64.subarray(at / 2 + 5, at / 2 + 8);
      const here = { slot: this.anchors.slot(reference), t: [t[0], t[1], t[2]], map: keyframe.map };
      if (this.before?.map === here.map) this.layer.add(this.before.slot, this.before.t, here.slot, here.t, tint(i));
      this.before = here;
    }
    this.layer.end();
  }
}
