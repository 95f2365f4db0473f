// Poses of keyframes in a texture, one slot each, so that moving the map moves points, edges and the path without touching them:
// what is drawn carries a slot and a place in that slot's keyframe. Slot 0 is the world, slot 1 is nowhere (not drawn).
import { DataTexture, FloatType, NearestFilter, RGBAFormat } from 'three';
import { IDENTITY } from './pose.ts';
import type { Pose } from './messages.ts';
import type { State } from './state.ts';

export const WORLD = 0;
export const NOWHERE = 1;
const WIDTH = 1024; // texels; two for each slot: quaternion · translation and scale (0: hidden)

// GLSL. `place` gives world coordinates of p in a slot, and whether it is to be seen.
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
vec3 place(float slot, vec3 p, bool scaled, out bool seen) {
  vec4 q = texelOf(int(slot), 0);
  vec4 t = texelOf(int(slot), 1);
  seen = t.w > 0.0;
  return turn(q, (scaled ? t.w : 1.0) * p) + t.xyz;
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

  // Shows the keyframes of `map`.
  update(state: State, map: number): void {
    for (const [id, slot] of this.slots) {
      const keyframe = state.keyframes.get(id);
      if (keyframe && keyframe.map === map) this.put(slot, keyframe.T_world_camera, keyframe.scale);
      else this.data[8 * slot + 7] = 0;
    }
    for (const keyframe of state.keyframes.values()) {
      if (!this.slots.has(keyframe.id)) this.put(this.slot(keyframe.id), keyframe.T_world_camera, keyframe.map === map ? keyframe.scale : 0);
    }
    this.uniform.value.needsUpdate = true;
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
