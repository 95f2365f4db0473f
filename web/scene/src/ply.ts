// Points, colors and triangles of a PLY file as the program writes it (binary, little-endian; Turk 1994).

// x y z; rgb 565; three indices for each triangle
export interface Ply { positions: Float32Array; colours: Uint16Array | null; triangles: Uint32Array | null }

const SIZES: Readonly<Record<string, number>> = { char: 1, uchar: 1, short: 2, ushort: 2, int: 4, uint: 4, float: 4, double: 8 };
const LONGEST_HEADER = 4096; // bytes

// Throws Error for other files.
export function readPly(bytes: Uint8Array): Ply {
  const text = new TextDecoder('latin1').decode(bytes.subarray(0, LONGEST_HEADER));
  const end = text.indexOf('end_header\n');
  if (!text.startsWith('ply\nformat binary_little_endian 1.0\n') || end < 0) throw new Error('it is not a binary PLY file');
  let count = 0;
  let faces = 0;
  let stride = 0;
  const at = new Map<string, number>();
  for (const line of text.slice(0, end).split('\n')) {
    const [word, kind, name] = line.split(' ') as [string, string, string];
    if (word === 'element' && kind === 'vertex') count = Number(name);
    if (word === 'element' && kind === 'face') faces = Number(name);
    if (word !== 'property' || (faces > 0 && kind === 'list')) continue;
    const size = SIZES[kind];
    if (size === undefined) throw new Error(`its property "${line}" is unknown`);
    at.set(`${kind} ${name}`, stride);
    stride += size;
  }
  const [x, y, z] = ['float x', 'float y', 'float z'].map((name) => at.get(name));
  const [r, g, b] = ['uchar red', 'uchar green', 'uchar blue'].map((name) => at.get(name));
  const begin = end + 'end_header\n'.length;
  if (x === undefined || y === undefined || z === undefined) throw new Error('its points have no positions');
  if (!(bytes.length >= begin + count * stride)) throw new Error('its end is missing');
  const view = new DataView(bytes.buffer, bytes.byteOffset + begin, bytes.length - begin);
  const positions = new Float32Array(3 * count);
  const colours = r === undefined || g === undefined || b === undefined ? null : new Uint16Array(count);
  for (let i = 0; i < count; ++i) {
    const from = i * stride;
    positions.set([view.getFloat32(from + x, true), view.getFloat32(from + y, true), view.getFloat32(from + z, true)], 3 * i);
    if (colours) colours[i] = (view.getUint8(from + r!) >> 3 << 11) | (view.getUint8(from + g!) >> 2 << 5) | (view.getUint8(from + b!) >> 3);
  }
  return { positions, colours, triangles: faces > 0 ? readFaces(view, count * stride, faces, count) : null };
}

// Each face as `list uchar int`: the number 3, then three indices.
function readFaces(view: DataView, begin: number, count: number, vertices: number): Uint32Array {
  const BYTES = 13;
  if (view.byteLength < begin + count * BYTES) throw new Error('its end is missing');
  const triangles = new Uint32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const from = begin + i * BYTES;
    if (view.getUint8(from) !== 3) throw new Error('it has faces that are no triangles');
    for (let k = 0; k < 3; ++k) triangles[3 * i + k] = view.getUint32(from + 1 + 4 * k, true);
  }
  if (triangles.some((index) => index >= vertices)) throw new Error('a face names a point that does not exist');
  return triangles;
}
