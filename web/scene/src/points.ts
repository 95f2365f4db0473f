// Draws points in one call: x y z in a keyframe, its slot, and a color (rgb 565, clouds only).
import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, GLSL3, Points, ShaderMaterial } from 'three';
import { PLACE } from './anchors.ts';
import type { Anchors } from './anchors.ts';
import type { Vector } from './pose.ts';

const VERTEX = /* glsl */ `
${PLACE}
in float slot;
in float colour;
uniform vec3 ink;
uniform vec3 ground;
uniform bool coloured;
uniform float size;
out vec3 shade;
void main() {
  float strength;
  vec3 p = place(slot, position, true, strength);
  gl_Position = strength > 0.0 ? projectionMatrix * modelViewMatrix * vec4(p, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = size;
  int c = int(colour);
  shade = coloured ? vec3(float(c >> 11), float(c >> 5 & 63) * 0.492, float(c & 31)) / 31.0 : ink;
  shade = mix(ground, shade, strength);
}`;

const FRAGMENT = /* glsl */ `
in vec3 shade;
out vec4 result;
void main() {
  result = vec4(shade, 1.0);
}`;

export class PointLayer {
  readonly object: Points<BufferGeometry, ShaderMaterial>;
  count = 0;
  private places = new Float32Array(0);
  private slots = new Float32Array(0);
  private colours = new Float32Array(0);
  private step = 1;
  private everyNth: Uint32Array | null = null;

  constructor(anchors: Anchors, private readonly coloured: boolean, size: number) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT,
      uniforms: { poses: anchors.uniform, ink: { value: new Color() }, ground: { value: new Color() }, coloured: { value: coloured }, size: { value: size } },
    });
    this.object = new Points(new BufferGeometry(), material);
    this.object.frustumCulled = false; // positions are relative to keyframes, so three.js cannot cull
  }

  set ground(colour: string) { this.object.material.uniforms.ground.value.setStyle(colour); }
  set ink(colour: string) { this.object.material.uniforms.ink.value.setStyle(colour); }
  set size(pixels: number) { this.object.material.uniforms.size.value = pixels; }

  // Ensures capacity for `count` points; keeps the existing ones.
  reserve(count: number): void {
    if (count <= this.slots.length) return;
    const room = Math.max(4096, Math.ceil(1.5 * count));
    const grown = (old: Float32Array, size: number) => {
      const array = new Float32Array(size * room);
      array.set(old);
      return array;
    };
    this.places = grown(this.places, 3);
    this.slots = grown(this.slots, 1);
    if (this.coloured) this.colours = grown(this.colours, 1);
    const geometry = new BufferGeometry();
    this.object.geometry.dispose();
    this.object.geometry = geometry;
    const attribute = (name: string, array: Float32Array, size: number) =>
      geometry.setAttribute(name, new BufferAttribute(array, size).setUsage(DynamicDrawUsage));
    attribute('position', this.places, 3);
    attribute('slot', this.slots, 1);
    if (this.coloured) attribute('colour', this.colours, 1);
    this.everyNth = null;
    this.range();
  }

  set(i: number, slot: number, x: number, y: number, z: number, colour = 0): void {
    this.places[3 * i] = x;
    this.places[3 * i + 1] = y;
    this.places[3 * i + 2] = z;
    this.slots[i] = slot;
    if (this.coloured) this.colours[i] = colour;
  }

  slotOf(i: number): number { return this.slots[i]!; }
  at(i: number): Vector { return [this.places[3 * i]!, this.places[3 * i + 1]!, this.places[3 * i + 2]!]; }

  hide(i: number, slot: number): void {
    this.slots[i] = slot;
  }

  changed(from: number, to: number): void {
    if (to <= from) return;
    const upload = (name: string, size: number) => {
      const attribute = this.object.geometry.getAttribute(name) as BufferAttribute | undefined;
      if (!attribute) return;
      attribute.addUpdateRange(size * from, size * (to - from));
      attribute.needsUpdate = true;
    };
    upload('position', 3);
    upload('slot', 1);
    upload('colour', 1);
  }

  // Draws every `step`th point only.
  thin(step: number): void {
    if (step === this.step && (step === 1 || this.everyNth)) return this.range();
    this.step = step;
    const geometry = this.object.geometry;
    if (step === 1) {
      geometry.setIndex(null);
    } else {
      const every = new Uint32Array(Math.floor(this.slots.length / step));
      for (let i = 0; i < every.length; ++i) every[i] = i * step;
      this.everyNth = every;
      geometry.setIndex(new BufferAttribute(every, 1));
    }
    this.range();
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  private range(): void {
    if (this.step > 1 && !this.everyNth) return this.thin(this.step);
    this.object.geometry.setDrawRange(0, Math.floor(this.count / this.step));
  }
}
