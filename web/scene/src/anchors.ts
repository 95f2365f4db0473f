// Poses of keyframes in a texture, one slot each. Vertices store a slot and a position in that slot's keyframe, so that
// moving keyframes does not change points, edges and the path. Slot 0 is the world, slot 1 is hidden. Keyframes of maps
// other than the active one are drawn faintly, each map in its own world, because their relative pose is unknown.
import { DataTexture, FloatType, NearestFilter, RGBAFormat } from 'three';
import { IDENTITY, transform } from './pose.ts';
import type { Vector } from './pose.ts';
import type { Pose } from './messages.ts';
import type { State } from './state.ts';

export const WORLD = 0;
export const NOWHERE = 1;
// Texels per row; two per slot: the quaternion, then translation and scale (0: hidden; negative: faint).
const WIDTH = 1024;

const FAINT = 0.3; // opacity relative to the active map

// GLSL. `place` returns the world coordinates of p in a slot, and its strength 0…1.
export const PLACE = /* glsl */ `
uniform highp sampler2D poses;
vec4 texelOf(int slot, int half_) {
  int at = 2 * slot + half_;
  return texelFetch(poses, ivec2(at % ${WIDTH}, at / ${WIDTH}), 0);
}
vec3 turn(vec4 q, vec3 p) {
  vec3 c = 2.0 * cross(q.xyz, p);
  return p + q.w * c + cross(q.xyz, c);
}
vec3 place(float slot, vec3 p, bool scaled, out float strength) {
  vec4 q = texelOf(int(slot), 0);
  vec4 t = texelOf(int(slot), 1);
  strength = t.w == 0.0 ? 0.0 : t.w > 0.0 ? 1.0 : ${FAINT};
  return turn(q, (scaled ? abs(t.w) : 1.0) * p) + t.xyz;
}`;

export class Anchors {
  readonly uniform: { value: DataTexture };
  private readonly slots = new Map<number, number>(); // by keyframe id
  private data = new Float32Array(4 * WIDTH * 2);

  constructor() {
    this.uniform = { value: this.texture() };
    this.put(WORLD, IDENTITY, 1);
    this.put(NOWHERE, IDENTITY, 0);
  }

  // Slot of a keyframe; permanent, even before the keyframe is known and after it is removed.
  slot(keyframe: number): number {
    let slot = this.slots.get(keyframe);
    if (slot === undefined) {
      slot = this.slots.size + 2;
      this.slots.set(keyframe, slot);
      if (8 * (slot + 1) > this.data.length) this.grow();
    }
    return slot;
  }

  // Shows the keyframes of `map`, and those of other maps faintly or not at all. Returns whether there are other maps.
  update(state: State, map: number, others: boolean): boolean {
    let several = false;
    for (const [id, slot] of this.slots) if (!state.keyframes.has(id)) this.data[8 * slot + 7] = 0;
    for (const { id, map: of, T_world_camera, scale } of state.keyframes.values()) {
      this.put(this.slot(id), T_world_camera, of === map ? scale : others ? -scale : 0);
      if (of !== map) several = true;
    }
    this.uniform.value.needsUpdate = true;
    return several;
  }

  // World coordinates of a point in a slot; null: not drawn, or in another map.
  place(slot: number, p: Vector): Vector | null {
    const at = 8 * slot;
    const { data } = this;
    const scale = data[at + 7]!;
    return scale > 0 ? transform([...data.subarray(at, at + 7)] as unknown as Pose, scale, ...p) : null;
  }

  dispose(): void {
    this.uniform.value.dispose();
  }

  private put(slot: number, T: Pose, scale: number): void {
    this.data.set([T[0], T[1], T[2], T[3], T[4], T[5], T[6], scale], 8 * slot);
  }

  private grow(): void {
    const data = new Float32Array(2 * this.data.length);
    data.set(this.data);
    this.data = data;
    this.uniform.value.dispose();
    this.uniform.value = this.texture();
  }

  private texture(): DataTexture {
    const texture = new DataTexture(this.data, WIDTH, this.data.length / (4 * WIDTH), RGBAFormat, FloatType);
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    return texture;
  }
}
