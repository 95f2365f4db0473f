// A mesh with the colors of its vertices, as `alidade mesh` writes it.
import { BufferAttribute, BufferGeometry, DoubleSide, Matrix4, Mesh, MeshBasicMaterial, Quaternion, Vector3 } from 'three';
import type { Ply } from './ply.ts';
import type { Pose } from './messages.ts';

// Light of an sRGB value (IEC 61966-2-1), both from 0 to 1: three.js turns it back when it draws.
function linear(s: number): number {
  return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4;
}

// `T_world_mesh`: of its vertices. Colors are drawn as they are, because images contain the light.
export function surfaceOf({ positions, colours, triangles }: Ply, T_world_mesh: Pose): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(triangles ?? new Uint32Array(), 1));
  const count = positions.length / 3;
  const rgb = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const c = colours?.[i] ?? 0x8410;
    rgb.set([linear((c >> 11) / 31), linear((c >> 5 & 63) / 63), linear((c & 31) / 31)], 3 * i);
  }
  geometry.setAttribute('color', new BufferAttribute(rgb, 3));
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));
  const [x, y, z, w, ...t] = T_world_mesh;
  mesh.applyMatrix4(new Matrix4().compose(new Vector3(...t), new Quaternion(x, y, z, w), new Vector3(1, 1, 1)));
  return mesh;
}
