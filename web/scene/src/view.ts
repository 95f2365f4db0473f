// Viewpoint of the scene: `follow` moves with the tracked camera, `orbit` stays where the user left it, `top` looks
// down. World → three.js: upright, y up, first camera looking along -z.
import CameraControls from 'camera-controls';
import { Box3, Matrix4, PerspectiveCamera, Quaternion, Raycaster, Sphere, Spherical, Vector2, Vector3, Vector4, MathUtils } from 'three';
import type { Pose } from './messages.ts';
import { rotate } from './pose.ts';
import type { Vector } from './pose.ts';

CameraControls.install({ THREE: { Vector2, Vector3, Vector4, Quaternion, Matrix4, Spherical, Box3, Sphere, Raycaster, MathUtils } as never });

export type ViewMode = 'follow' | 'orbit' | 'top';

export interface Extent { centre: Vector; radius: number } // in the world

export class View {
  readonly camera = new PerspectiveCamera(50, 1, 0.01, 1000);
  readonly controls: CameraControls;
  mode: ViewMode = 'follow';
  touched = false; // the user has moved the view: no automatic changes
  private drawn: number[] = Array(16).fill(NaN) as number[]; // the camera's matrix at the last changed image
  private free = 1; // visible share of the width
  private size = 1; // typical viewing distance

  constructor(element: HTMLElement, private readonly toScene: Matrix4, changed: () => void) {
    this.controls = new CameraControls(this.camera, element);
    this.controls.smoothTime = 0.25; // seconds
    this.controls.draggingSmoothTime = 0.05;
    this.controls.dollyToCursor = true;
    this.controls.addEventListener('controlstart', () => { this.touched = true; });
    this.controls.addEventListener('control', changed);
    this.controls.addEventListener('wake', changed);
    void this.controls.setLookAt(0, 1.2, 3, 0, 0, -2, false);
  }

  // Advances the animation; returns whether the change is visible.
  step(seconds: number): boolean {
    if (!this.controls.update(seconds)) return false;
    this.camera.updateMatrix();
    const { elements } = this.camera.matrix;
    const bound = (i: number) => (i < 12 ? 1e-4 : 1e-4 * this.size); // 1e-4 radians are less than a tenth of a pixel
    const moved = elements.some((value, i) => !(Math.abs(value - this.drawn[i]) <= bound(i)));
    if (moved) this.drawn = [...elements];
    return moved;
  }

  // Sets the typical distance of the scene, world units, from which near and far planes and the viewing distance
  // follow.
  setSize(size: number): void {
    const first = this.size !== size;
    this.size = size;
    if (!first) return;
    this.camera.near = 0.01 * size;
    this.camera.far = 1000 * size;
    this.camera.updateProjectionMatrix();
    this.controls.minDistance = 0.05 * size;
    this.controls.maxDistance = 300 * size;
  }

  // Places the view behind and above the tracked camera, in its viewing direction.
  behind(T_world_camera: Pose, smooth: boolean): void {
    const at = this.vector([T_world_camera[4], T_world_camera[5], T_world_camera[6]]);
    const forward = this.direction(rotate(T_world_camera, 0, 0, 1));
    forward.y = 0;
    if (forward.lengthSq() < 1e-4) forward.set(0, 0, -1);
    forward.normalize();
    const eye = at.clone().addScaledVector(forward, -1.1 * this.size);
    eye.y += 0.7 * this.size;
    const target = at.clone().addScaledVector(forward, 0.3 * this.size);
    void this.controls.setLookAt(eye.x, eye.y, eye.z, target.x, target.y, target.z, smooth);
  }

  follow(T_world_camera: Pose): void {
    if (this.mode !== 'follow') return;
    if (!this.touched) return this.behind(T_world_camera, true);
    const at = this.vector([T_world_camera[4], T_world_camera[5], T_world_camera[6]]);
    void this.controls.moveTo(at.x, at.y, at.z, true);
  }

  top(extent: Extent, smooth: boolean): void {
    const at = this.vector(extent.centre);
    const half = Math.tan(MathUtils.degToRad(this.camera.fov / 2)) * Math.min(1, this.camera.aspect * this.free);
    const height = (1.15 * extent.radius) / half;
    void this.controls.setLookAt(at.x, at.y + height, at.z + 1e-4 * height, at.x, at.y, at.z, smooth);
  }

  around(extent: Extent, smooth: boolean): void {
    const at = this.vector(extent.centre);
    const half = Math.tan(MathUtils.degToRad(this.camera.fov / 2)) * Math.min(1, this.camera.aspect * this.free);
    const distance = (1.1 * extent.radius) / half;
    void this.controls.setLookAt(at.x + 0.45 * distance, at.y + 0.55 * distance, at.z + 0.7 * distance, at.x, at.y, at.z, smooth);
  }

  setMode(mode: ViewMode): void {
    this.mode = mode;
    this.touched = false;
    const { ACTION } = CameraControls;
    this.controls.mouseButtons.left = mode === 'top' ? ACTION.TRUCK : ACTION.ROTATE;
    this.controls.touches.one = mode === 'top' ? ACTION.TOUCH_TRUCK : ACTION.TOUCH_ROTATE;
  }

  // CSS pixels; `left` and `right` are covered by other elements, so the scene is centered in the remaining width.
  resize(width: number, height: number, left: number, right: number): void {
    this.camera.aspect = width / Math.max(1, height);
    this.free = Math.max(0.3, (width - left - right) / width);
    this.camera.setViewOffset(width, height, (right - left) / 2, 0, width, height);
  }

  private vector(p: Vector): Vector3 {
    return new Vector3(...p).applyMatrix4(this.toScene);
  }

  private direction(d: Vector): Vector3 {
    return new Vector3(...d).transformDirection(this.toScene);
  }
}
