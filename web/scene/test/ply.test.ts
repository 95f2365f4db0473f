// Clouds of the program's PLY files.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readPly } from '../src/ply.ts';

const HEADER = 'ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n' +
  'property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float sigma\nend_header\n';

function file(header = HEADER): Uint8Array {
  const points = new DataView(new ArrayBuffer(2 * 31));
  [[1, 2, 3], [-4, 5.5, 6]].forEach((p, i) => {
    p.forEach((value, k) => points.setFloat32(31 * i + 4 * k, value, true));
    [255, 4 * i, 8].forEach((value, k) => points.setUint8(31 * i + 12 + k, value));
    points.setFloat32(31 * i + 27, 0.25, true);
  });
  return Uint8Array.from([...new TextEncoder().encode(header), ...new Uint8Array(points.buffer)]);
}

test('positions and colors, beside normals and deviations', () => {
  const { positions, colours } = readPly(file());
  assert.deepEqual([...positions], [1, 2, 3, -4, 5.5, 6]);
  assert.deepEqual([...colours!], [(31 << 11) | 1, (31 << 11) | (1 << 5) | 1]);
});

test('a file that ends early or is another one is refused', () => {
  assert.throws(() => readPly(file().subarray(0, -1)), /end is missing/);
  assert.throws(() => readPly(file(HEADER.replace('binary_little_endian', 'ascii'))), /not a binary PLY/);
  assert.throws(() => readPly(file(HEADER.replace('float x', 'float w'))), /no positions/);
  assert.throws(() => readPly(file(HEADER.replace('float sigma', 'list uchar int q'))), /unknown/);
});

test('triangles of a mesh', () => {
  const mesh = (last: number) => {
    const faces = new DataView(new ArrayBuffer(13));
    faces.setUint8(0, 3);
    [0, 1, last].forEach((index, k) => faces.setUint32(1 + 4 * k, index, true));
    const header = HEADER.replace('end_header\n', 'element face 1\nproperty list uchar int vertex_indices\nend_header\n');
    return Uint8Array.from([...file(header), ...new Uint8Array(faces.buffer)]);
  };
  assert.deepEqual([...readPly(mesh(1)).triangles!], [0, 1, 1]);
  assert.equal(readPly(file()).triangles, null);
  assert.throws(() => readPly(mesh(2)), /does not exist/);
  assert.throws(() => readPly(mesh(1).subarray(0, -1)), /end is missing/);
});
