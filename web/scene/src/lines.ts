// Segments of lines in one call: both ends carry a slot and a place in that slot's keyframe. WebGL's own lines are one pixel wide,
// so each is two triangles, widened on the screen, with soft edges.
import { BufferAttribute, Color, DynamicDrawUsage, GLSL3, InstancedBufferGeometry, InstancedInterleavedBuffer, InterleavedBufferAttribute,
  Mesh, ShaderMaterial, Vector2 } from 'three';
import { PLACE } from './anchors.ts';
import type { Anchors } from './anchors.ts';

const FLOATS = 9; // of a segment: place and slot of each end, a number for its colour

const VERTEX = /* glsl */ `
${PLACE}
in vec3 from;
in float fromSlot;
in vec3 to;
in float toSlot;
in float tint;
uniform vec2 resolution;
uniform float width;
uniform bool scaled;
out float across;
out float mixed;
void main() {
  bool a_seen, b_seen;
  vec4 a = modelViewMatrix * vec4(place(fromSlot, from, scaled, a_seen), 1.0);
  vec4 b = modelViewMatrix * vec4(place(toSlot, to, scaled, b_seen), 1.0);
  // What is behind the eye is cut off at a small distance, or it would turn over.
  const float near = -0.001;
  bool perspective = projectionMatrix[3][3] == 0.0;
  if (!a_seen || !b_seen || (perspective && a.z > near && b.z > near)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (perspective && a.z > near) a = mix(b, a, (b.z - near) / (b.z - a.z));
  if (perspective && b.z > near) b = mix(a, b, (a.z - near) / (a.z - b.z));
  vec4 ca = projectionMatrix * a;
  vec4 cb = projectionMatrix * b;
  vec2 along = (cb.xy / cb.w - ca.xy / ca.w) * resolution;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  vec2 aside = vec2(-along.y, along.x) * (width + 1.0) / resolution;
  vec4 c = position.x < 0.5 ? ca : cb;
  across = position.y * (width + 1.0) * 0.5;
  c.xy += (position.y * aside + (position.x - 0.5) * along * 0.5 / resolution) * c.w;
  mixed = tint;
  gl_Position = c;
}`;

const FRAGMENT = /* glsl */ `
in float across;
in float mixed;
uniform float width;
uniform vec3 ink;
uniform vec3 other;
uniform float opacity;
out vec4 result;
void main() {
  float soft = clamp(0.5 * width + 0.5 - abs(across), 0.0, 1.0);
  result = vec4(mix(ink, other, mixed), soft * opacity);
}`;

export class LineLayer {
  readonly object: Mesh<InstancedBufferGeometry, ShaderMaterial>;
  private data = new Float32Array(0);
  private buffer: InstancedInterleavedBuffer | null = null;
  private count = 0;

  // `scaled`: places are told as if the keyframe's scale were 1, else as they are.
  constructor(anchors: Anchors, resolution: { value: Vector2 }, width: number, opacity: number, scaled = true) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false,
      uniforms: {
        poses: anchors.uniform, resolution, width: { value: width }, opacity: { value: opacity }, scaled: { value: scaled },
        ink: { value: new Color() }, other: { value: new Color() },
      },
    });
    this.object = new Mesh(new InstancedBufferGeometry(), material);
    this.object.frustumCulled = false;
  }

  ink(colour: string, other = colour): void {
    this.object.material.uniforms.ink.value.setStyle(colour);
    this.object.material.uniforms.other.value.setStyle(other);
  }

  set width(pixels: number) { this.object.material.uniforms.width.value = pixels; }

  // Begins anew, with room for so many.
  begin(count: number): void {
    this.count = 0;
    if (this.buffer && FLOATS * count <= this.data.length) return;
    this.data = new Float32Array(FLOATS * Math.max(256, Math.ceil(1.5 * count)));
    this.buffer = new InstancedInterleavedBuffer(this.data, FLOATS);
    this.buffer.setUsage(DynamicDrawUsage);
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const attribute = (name: string, size: number, at: number) =>
      geometry.setAttribute(name, new InterleavedBufferAttribute(this.buffer!, size, at));
    attribute('from', 3, 0);
    attribute('fromSlot', 1, 3);
    attribute('to', 3, 4);
    attribute('toSlot', 1, 7);
    attribute('tint', 1, 8);
    this.object.geometry.dispose();
    this.object.geometry = geometry;
  }

  add(fromSlot: number, from: ArrayLike<number>, toSlot: number, to: ArrayLike<number>, tint = 0): void {
    const at = FLOATS * this.count++;
    const { data } = this;
    data[at] = from[0];
    data[at + 1] = from[1];
    data[at + 2] = from[2];
    data[at + 3] = fromSlot;
    data[at + 4] = to[0];
    data[at + 5] = to[1];
    data[at + 6] = to[2];
    data[at + 7] = toSlot;
    data[at + 8] = tint;
  }

  end(): void {
    this.object.geometry.instanceCount = this.count;
    this.object.visible = this.count > 0;
    if (!this.buffer || this.count === 0) return;
    this.buffer.clearUpdateRanges();
    this.buffer.addUpdateRange(0, FLOATS * this.count);
    this.buffer.needsUpdate = true;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
