// A mesh with the colors of its vertices, as `alidade mesh` writes it.
import { BufferAttribute, BufferGeometry, DoubleSide, Matrix4, Mesh, MeshBasicMaterial, Quaternion, Vector3 } from 'three';
import type { Ply } from './ply.ts';
import type { Pose } from './messages.ts';

// `T_world_mesh`: of its vertices. Colors are drawn as they are, because images contain the light.
export function surfaceOf({ positions, colours, triangles }: Ply, T_world_mesh: Pose): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(triangles ?? new Uint32Array(), 1));
  const count = positions.length / 3;
  const rgb = new Uint8Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const c = colours?.[i] ?? 0x8410;
    rgb.set([(c >> 11) * 255 / 31, (c >> 5 & 63) * 255 / 63, (c & 31) * 255 / 31], 3 * i);
  }
  geometry.setAttribute('color', new BufferAttribute(rgb, 3, true));
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));
  const [x, y, z, w, ...t] = T_world_mesh;
  mesh.applyMatrix4(new Matrix4().compose(new Vector3(...t), new Quaternion(x, y, z, w), new Vector3(1, 1, 1)));
  return mesh;
}
