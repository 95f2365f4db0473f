// The three.js scene of a state. Keeps no data except GPU buffers and the viewpoint.
import { ColorManagement, Group, Scene as ThreeScene, Vector2, Vector3, WebGLRenderer } from 'three';
import type { Alignment } from './align.ts';
import { Anchors, WORLD } from './anchors.ts';
import { CloudUpload, corners, drawEdges, drawFrusta, LandmarkUpload, PathUpload } from './layers.ts';
import { LineLayer } from './lines.ts';
import type { Pose } from './messages.ts';
import { NONE } from './messages.ts';
import { pick } from './pick.ts';
import type { Ply } from './ply.ts';
import { transform } from './pose.ts';
import type { Vector } from './pose.ts';
import { PointLayer } from './points.ts';
import type { State } from './state.ts';
import { Thinning } from './thinning.ts';
import { extentOf, typicalDistance } from './extent.ts';
import { surfaceOf } from './surface.ts';
import { upright } from './upright.ts';
import { View } from './view.ts';
import type { ViewMode } from './view.ts';

ColorManagement.enabled = false; // colors are those of the page, without conversion

const LEANING = 0.1; // radians
const HUNG_LEANING = 0.01; // radians; up by gravity is more certain

export const LAYERS = ['path', 'keyframes', 'landmarks', 'cloud', 'covisibility', 'loops', 'truth', 'camera', 'others'] as const;
export type LayerName = (typeof LAYERS)[number];

export interface Colours { page: string; ink: string; soft: string; path: string; dot: string; loop: string; truth: string; camera: string; worst: string }

// WebGL is not available.
export class NoWebGL extends Error {}

export class Scene {
  readonly view: View;
  readonly layers: Record<LayerName, { visible: boolean }>;
  private readonly renderer: WebGLRenderer;
  private readonly three = new ThreeScene();
  private readonly world = new Group(); // T_scene_world
  private readonly anchors = new Anchors();
  private readonly resolution = { value: new Vector2(1, 1) };
  private readonly points: { landmarks: PointLayer; cloud: PointLayer };
  private readonly shape: PointLayer; // a cloud of its own, in the world
  private readonly lines: Record<Exclude<LayerName, 'landmarks' | 'cloud' | 'others'>, LineLayer>;
  private readonly landmarkUpload: LandmarkUpload;
  private readonly cloudUpload: CloudUpload;
  private readonly pathUpload: PathUpload;
  private readonly thinning: Thinning | undefined;
  private drawn: { keyframes: unknown; path: unknown; frame: unknown; map: bigint; active: number } | null = null;
  private state: State | null = null;
  private active = NONE; // the active map, in which the camera is
  several = false; // there are maps other than the active one
  private placed = false;
  private covered = { left: 0, right: 0 };
  private levelled = 0; // number of keyframes when `up` was last estimated
  private frameRequest = 0;
  private before = 0;
  private errors: ((i: number) => number) | null = null;
  private hung = false; // up is by gravity
  drew: () => void = () => {}; // called after each image

  constructor(private readonly canvas: HTMLCanvasElement) {
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: 'low-power' });
    } catch (error) {
      throw new NoWebGL(String(error));
    }
    this.world.rotation.x = Math.PI;
    this.world.matrixAutoUpdate = false;
    this.world.updateMatrix();
    this.three.add(this.world);
    this.view = new View(canvas, this.world.matrix, () => this.invalidate());
    this.points = { landmarks: new PointLayer(this.anchors, false, 2), cloud: new PointLayer(this.anchors, true, 2) };
    const line = (width: number, opacity: number, scaled = true) => new LineLayer(this.anchors, this.resolution, width, opacity, scaled);
    this.lines = {
      covisibility: line(1, 0.35), keyframes: line(1, 0.8, false), loops: line(2.5, 1), truth: line(1.5, 0.9), path: line(2.5, 1),
      camera: line(2.5, 1, false),
    };
    const layers: Record<string, { visible: boolean }> = { others: { visible: true } };
    [...Object.entries(this.points), ...Object.entries(this.lines)].forEach(([name, layer], order) => {
      const holder = new Group();
      layer.object.renderOrder = order;
      holder.add(layer.object);
      this.world.add(holder);
      layers[name] = holder;
    });
    this.layers = layers as never;
    this.shape = new PointLayer(this.anchors, true, 2);
    (layers.cloud as Group).add(this.shape.object);
    this.landmarkUpload = new LandmarkUpload(this.points.landmarks, this.anchors);
    this.cloudUpload = new CloudUpload(this.points.cloud, this.anchors);
    this.pathUpload = new PathUpload(this.lines.path, this.anchors);
    this.thinning = new Thinning([this.points.landmarks, this.points.cloud, this.shape], () => this.invalidate());
    this.resize();
  }

  colours(c: Colours): void {
    this.renderer.setClearColor(c.page, 1);
    this.points.landmarks.ink = c.dot;
    this.points.landmarks.ground = this.points.cloud.ground = this.shape.ground = c.page;
    this.lines.path.ink(c.path, c.worst);
    this.lines.keyframes.ink(c.path);
    this.lines.covisibility.ink(c.dot);
    this.lines.loops.ink(c.loop);
    this.lines.truth.ink(c.truth);
    this.lines.camera.ink(c.camera);
    this.invalidate();
  }

  show(layer: LayerName, visible: boolean): void {
    this.layers[layer].visible = visible;
    if ((layer === 'truth' || layer === 'others') && this.state) {
      this.drawn = null; // force an update, because it changes the path's colors or the visible keyframes
      this.update(this.state);
    }
    this.invalidate();
  }

  setMode(mode: ViewMode): void {
    this.view.setMode(mode);
    const pose = this.state?.cameraPose();
    if (mode === 'follow' && pose) this.view.behind(pose, true);
    if (mode === 'top' && this.state) this.view.top(extentOf(this.state, this.active), true);
    this.invalidate();
  }

  // Fits the whole map into the view.
  fit(): void {
    if (!this.state) return;
    const extent = extentOf(this.state, this.active);
    if (this.view.mode === 'top') this.view.top(extent, true);
    else this.view.around(extent, true);
    this.invalidate();
  }

  // The ground truth aligned to the map, with the error of each frame of the path; null: unknown.
  overlay(alignment: Alignment | null): void {
    const layer = this.lines.truth;
    layer.begin(alignment?.truth.length ?? 0);
    for (let i = 1; i < (alignment?.truth.length ?? 0); ++i) layer.add(WORLD, alignment!.truth[i - 1], WORLD, alignment!.truth[i]);
    layer.end();
    this.errors = alignment && ((i) => (alignment.errors[i] / (alignment.worst || 1)) || 0);
    this.drawn = null;
    this.invalidate();
  }

  update(state: State): void {
    this.state = state;
    const { frame } = state;
    this.active = state.activeMap;
    const drawn = this.drawn;
    const mapChanged = !drawn || drawn.keyframes !== state.keyframes || drawn.map !== state.mapVersion || drawn.active !== this.active;
    if (mapChanged) {
      this.several = this.anchors.update(state, this.active, this.layers.others.visible);
      const size = typicalDistance(state, this.active);
      this.view.setSize(size);
      drawFrusta(this.lines.keyframes, state, this.anchors, 0.05 * size);
      drawEdges(this.lines.covisibility, state, this.anchors, (keyframe) => keyframe.covisible);
      drawEdges(this.lines.loops, state, this.anchors, (keyframe) => keyframe.loops);
      this.landmarkUpload.update(state);
      this.cloudUpload.update(state);
      this.level(state);
    }
    if (mapChanged || drawn?.frame !== frame) {
      const anew = mapChanged || drawn?.path !== state.path;
      this.pathUpload.update(state, anew, this.errors && this.layers.truth.visible ? this.errors : () => 0);
    }
    this.placeCamera(state.cameraPose(), state);
    this.drawn = { keyframes: state.keyframes, path: state.path, frame, map: state.mapVersion, active: this.active };
    this.invalidate();
  }

  // Clears everything for another run.
  forget(): void {
    this.placed = false;
    this.levelled = 0;
    this.hung = false;
    this.view.touched = false;
    this.state = null;
    this.active = NONE;
    this.drawn = null;
    this.overlay(null);
  }

  // Projects a world point to CSS pixels relative to the canvas; null: behind the camera.
  project(p: readonly number[]): { x: number; y: number } | null {
    this.view.camera.updateMatrixWorld();
    const at = new Vector3(p[0], p[1], p[2]).applyMatrix4(this.world.matrix).applyMatrix4(this.view.camera.matrixWorldInverse);
    if (at.z >= 0) return null;
    at.applyMatrix4(this.view.camera.projectionMatrix);
    return { x: (0.5 * at.x + 0.5) * this.canvas.clientWidth, y: (0.5 - 0.5 * at.y) * this.canvas.clientHeight };
  }

  // The drawn point at this place of the canvas, CSS pixels; null: none is near.
  pick(x: number, y: number): Vector | null {
    const { camera } = this.view;
    camera.updateMatrixWorld();
    const clip = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).multiply(this.world.matrix);
    const { landmarks, cloud } = this.layers;
    const layers = [...(landmarks.visible ? [this.points.landmarks] : []), ...(cloud.visible ? [this.points.cloud, this.shape] : [])];
    return pick(layers, this.anchors, clip.elements, this.canvas.clientWidth, this.canvas.clientHeight, x, y);
  }

  // CSS pixels of a unit of the map at the distance of the point that the view looks at.
  get pixelsPerUnit(): number {
    const { camera, controls } = this.view;
    return this.canvas.clientHeight / (2 * Math.tan((camera.fov * Math.PI) / 360) * controls.distance);
  }

  // Shows a cloud with positions in the world of `T_world_cloud`, in the layer of the semi-dense points.
  setShape({ positions, colours }: Ply, T_world_cloud: Pose): void {
    const count = positions.length / 3;
    this.shape.reserve(count);
    for (let i = 0; i < count; ++i) {
      const p = transform(T_world_cloud, 1, positions[3 * i]!, positions[3 * i + 1]!, positions[3 * i + 2]!);
      this.shape.set(i, WORLD, ...p, colours?.[i] ?? 0x8410);
    }
    this.shape.count = count;
    this.shape.changed(0, count);
    this.invalidate();
  }

  // Shows a mesh in the same layer.
  setSurface(ply: Ply, T_world_mesh: Pose): void {
    (this.layers.cloud as Group).add(surfaceOf(ply, T_world_mesh));
    this.invalidate();
  }

  // Draws with all points, and copies the image into `onto` at the same moment, because the canvas is cleared later.
  copy(onto: CanvasRenderingContext2D): void {
    this.thinning?.apply(1);
    this.renderer.render(this.three, this.view.camera);
    onto.drawImage(this.canvas, 0, 0);
    this.invalidate();
  }

  // Widths in CSS pixels on the left and right of the canvas that are covered by other elements.
  insets(left: number, right: number): void {
    this.covered = { left, right };
    this.resize();
  }

  resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const ratio = Math.min(2, devicePixelRatio);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.resolution.value.set(width * ratio, height * ratio);
    this.points.landmarks.size = Math.round(2 * ratio);
    this.points.cloud.size = this.shape.size = Math.round(2 * ratio);
    this.view.resize(width, height, this.covered.left, this.covered.right);
    this.invalidate();
  }

  invalidate(): void {
    if (this.frameRequest) return;
    this.thinning?.request(performance.now());
    this.frameRequest = requestAnimationFrame((now) => this.render(now));
  }

  // Milliseconds to render an image with all points completely; the minimum of several.
  measure(pictures = 8): number {
    this.thinning?.apply(1);
    const gl = this.renderer.getContext();
    const pixel = new Uint8Array(4);
    let least = Infinity;
    for (let i = 0; i < pictures; ++i) {
      const begin = performance.now();
      this.renderer.render(this.three, this.view.camera);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      least = Math.min(least, performance.now() - begin);
    }
    this.invalidate();
    return least;
  }

  private render(now: number): void {
    this.frameRequest = 0;
    const seconds = Math.min(0.3, (now - this.before) / 1000);
    this.before = now;
    const moving = this.view.step(seconds);
    this.thinning?.before(now);
    this.renderer.render(this.three, this.view.camera);
    this.drew();
    if (moving) this.invalidate();
  }

  private placeCamera(pose: Pose | null, state: State): void {
    const layer = this.lines.camera;
    layer.begin(8);
    if (pose) {
      const of = corners(state.hello?.camera ?? null, 0.1 * typicalDistance(state, this.active));
      addFrustumAt(layer, pose, of);
      if (!this.placed && this.view.mode === 'follow') this.view.behind(pose, false);
      else this.view.follow(pose);
      this.placed = true;
    }
    layer.end();
  }

  // Re-estimates the up direction whenever the number of keyframes has doubled and when gravity has become known, and
  // applies it if it changed and the user has not moved the view.
  private level(state: State): void {
    const count = state.keyframes.size;
    const down = state.worlds.get(this.active)?.down ?? null;
    const news = down !== null && !this.hung;
    if (count === 0 || (this.levelled > 0 && ((count < 2 * this.levelled && !news) || this.view.touched))) return;
    const poses = [...state.keyframes.values()].filter((k) => k.map === this.active).map((k) => k.T_world_camera);
    this.hung = down !== null;
    const { right, forward, up } = upright(poses, down && [-down[0], -down[1], -down[2]]);
    const { elements: old } = this.world.matrix;
    const same = old[1] * up[0] + old[5] * up[1] + old[9] * up[2] > Math.cos(this.hung ? HUNG_LEANING : LEANING);
    if (this.levelled > 0 && same) {
      this.levelled = count;
      return;
    }
    this.levelled = count;
    this.world.matrix.set(
      right[0], right[1], right[2], 0, up[0], up[1], up[2], 0, -forward[0], -forward[1], -forward[2], 0, 0, 0, 0, 1);
    this.world.matrixWorldNeedsUpdate = true;
    this.placed = false;
  }
}

function addFrustumAt(layer: LineLayer, T: Pose, of: number[][]): void {
  const world = [[0, 0, 0], ...of].map((p) => transform(T, 1, p[0], p[1], p[2]));
  const [centre, ...rest] = world;
  rest.forEach((corner, k) => {
    layer.add(WORLD, centre, WORLD, corner);
    layer.add(WORLD, corner, WORLD, rest[(k + 1) % 4]);
  });
}
