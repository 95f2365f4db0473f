// Poses of keyframes in a texture, one slot each, so that moving the map moves points, edges and the path without touching them:
// what is drawn carries a slot and a place in that slot's keyframe. Slot 0 is the world, slot 1 is nowhere (not drawn). Keyframes of
// other maps than the one the camera is in are drawn faintly, each map in its own world: how they lie to each other is not known.
import { DataTexture, FloatType, NearestFilter, RGBAFormat } from 'three';
import { IDENTITY } from './pose.ts';
import type { Pose } from './messages.ts';
import type { State } from './state.ts';

export const WORLD = 0;
export const NOWHERE = 1;
const WIDTH = 1024; // texels; two for each slot: quaternion · translation and scale (0: hidden; below 0: faint)

const FAINT = 0.3; // of full strength

// GLSL. `place` gives world coordinates of p in a slot, and how strongly it is to be seen: 0…1.
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

  // Of a keyframe; one for ever, also before it is known and after it has gone.
  slot(keyframe: number): number {
    let slot = this.slots.get(keyframe);
    if (slot === undefined) {
      slot = this.slots.size + 2;
      this.slots.set(keyframe, slot);
      if (8 * (slot + 1) > this.data.length) this.grow();
    }
    return slot;
  }

  // Shows the keyframes of `map`, those of others faintly or not at all. Whether there are others.
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
