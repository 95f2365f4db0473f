// Draws line segments in one call; each end has a slot and a position in the slot's keyframe. WebGL lines are one pixel
// wide, so each segment consists of two triangles with soft edges. Not instanced, because software renderers execute
// one call per instance.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, GLSL3, InterleavedBuffer, InterleavedBufferAttribute, Mesh, ShaderMaterial,
  Vector2 } from 'three';
import { PLACE } from './anchors.ts';
import type { Anchors } from './anchors.ts';

const FLOATS = 9; // per corner: position and slot of both ends, and a number for the segment's color
const CORNERS = 4; // per segment

const VERTEX = /* glsl */ `
${PLACE}
in float fromSlot;
in vec3 to;
in float toSlot;
in float tint;
uniform vec2 resolution;
uniform float width;
uniform bool scaled;
out float across;
out float mixed;
out float strong;
void main() {
  float a_strength, b_strength;
  vec2 corner = vec2(float(gl_VertexID >> 1 & 1), float((gl_VertexID + 1) >> 1 & 1) * 2.0 - 1.0); // which end, which side
  vec4 a = modelViewMatrix * vec4(place(fromSlot, position, scaled, a_strength), 1.0);
  vec4 b = modelViewMatrix * vec4(place(toSlot, to, scaled, b_strength), 1.0);
  // What is behind the eye is cut off at a small distance, or it would turn over.
  const float near = -0.001;
  bool perspective = projectionMatrix[3][3] == 0.0;
  strong = min(a_strength, b_strength);
  if (strong == 0.0 || (perspective && a.z > near && b.z > near)) {
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
  vec4 c = corner.x < 0.5 ? ca : cb;
  across = corner.y * (width + 1.0) * 0.5;
  c.xy += (corner.y * aside + (corner.x - 0.5) * along * 0.5 / resolution) * c.w;
  mixed = tint;
  gl_Position = c;
}`;

const FRAGMENT = /* glsl */ `
in float across;
in float mixed;
in float strong;
uniform float width;
uniform vec3 ink;
uniform vec3 other;
uniform float opacity;
out vec4 result;
void main() {
  float soft = clamp(0.5 * width + 0.5 - abs(across), 0.0, 1.0);
  result = vec4(mix(ink, other, mixed), soft * opacity * strong);
}`;

export class LineLayer {
  readonly object: Mesh<BufferGeometry, ShaderMaterial>;
  private data = new Float32Array(0);
  private buffer: InterleavedBuffer | null = null;
  private count = 0;
  private uploaded = 0; // number of uploaded segments

  // `scaled`: positions are relative to the keyframe's scale; otherwise they are absolute.
  constructor(anchors: Anchors, resolution: { value: Vector2 }, width: number, opacity: number, scaled = true) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false, side: DoubleSide,
      uniforms: {
        poses: anchors.uniform, resolution, width: { value: width }, opacity: { value: opacity }, scaled: { value: scaled },
        ink: { value: new Color() }, other: { value: new Color() },
      },
    });
    this.object = new Mesh(new BufferGeometry(), material);
    this.object.frustumCulled = false;
  }

  ink(colour: string, other = colour): void {
    this.object.material.uniforms.ink.value.setStyle(colour);
    this.object.material.uniforms.other.value.setStyle(other);
  }

  set width(pixels: number) { this.object.material.uniforms.width.value = pixels; }

  // Starts over, with capacity for `count` segments.
  begin(count: number): void {
    this.count = 0;
    this.uploaded = 0;
    this.reserve(count);
  }

  // Ensures capacity for `count` segments; keeps the existing ones.
  reserve(count: number): void {
    const size = FLOATS * CORNERS;
    if (this.buffer && size * count <= this.data.length) return;
    const room = Math.max(256, Math.ceil(1.5 * count));
    const data = new Float32Array(size * room);
    data.set(this.data.subarray(0, size * this.count));
    this.data = data;
    this.uploaded = 0;
    this.buffer = new InterleavedBuffer(data, FLOATS);
    this.buffer.setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    const attribute = (name: string, of: number, at: number) => geometry.setAttribute(name, new InterleavedBufferAttribute(this.buffer!, of, at));
    attribute('position', 3, 0);
    attribute('fromSlot', 1, 3);
    attribute('to', 3, 4);
    attribute('toSlot', 1, 7);
    attribute('tint', 1, 8);
    const triangles = new Uint32Array(6 * room);
    for (let i = 0; i < room; ++i) [0, 1, 2, 0, 2, 3].forEach((corner, k) => { triangles[6 * i + k] = CORNERS * i + corner; });
    geometry.setIndex(new BufferAttribute(triangles, 1));
    this.object.geometry.dispose();
    this.object.geometry = geometry;
  }

  add(fromSlot: number, from: ArrayLike<number>, toSlot: number, to: ArrayLike<number>, tint = 0): void {
    const { data } = this;
    const first = FLOATS * CORNERS * this.count++;
    data[first] = from[0];
    data[first + 1] = from[1];
    data[first + 2] = from[2];
    data[first + 3] = fromSlot;
    data[first + 4] = to[0];
    data[first + 5] = to[1];
    data[first + 6] = to[2];
    data[first + 7] = toSlot;
    data[first + 8] = tint;
    for (let corner = 1; corner < CORNERS; ++corner) data.copyWithin(first + FLOATS * corner, first, first + FLOATS);
  }

  // Uploads the segments added since the last call.
  end(): void {
    this.object.geometry.setDrawRange(0, 6 * this.count);
    this.object.visible = this.count > 0;
    if (!this.buffer || this.count === this.uploaded) return;
    const size = FLOATS * CORNERS;
    this.buffer.addUpdateRange(size * this.uploaded, size * (this.count - this.uploaded));
    this.buffer.needsUpdate = true;
    this.uploaded = this.count;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
