// Encodes images for the sample's stream, and decodes screenshots.
import { deflateSync, inflateSync } from 'node:zlib';

const CRC = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n;
});

// 8-bit RGB; each row begins with its filter type, 0.
export function png(width: number, height: number, rows: Uint8Array): Uint8Array<ArrayBuffer> {
  const chunk = (type: string, data: Uint8Array) => {
    const out = Buffer.alloc(12 + data.length);
    out.writeUInt32BE(data.length, 0);
    out.write(type, 4, 'latin1');
    out.set(data, 8);
    let crc = 0xffffffff;
    for (const byte of out.subarray(4, 8 + data.length)) crc = CRC[(crc ^ byte) & 255] ^ (crc >>> 8);
    out.writeUInt32BE(~crc >>> 0, 8 + data.length);
    return out;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return new Uint8Array(Buffer.concat([signature, chunk('IHDR', head), chunk('IDAT', deflateSync(rows, { level: 1 })), chunk('IEND', new Uint8Array(0))]));
}

// Gray, RGB or RGBA with 8 or 16 bits, or 1-bit black and white (0, 1); not interlaced.
export function readPng(file: Buffer): { width: number; height: number; channels: number; samples: Uint16Array } {
  let at = 8;
  const data: Buffer[] = [];
  let [width, height, channels, bytes] = [0, 0, 0, 1];
  while (at < file.length) {
    const length = file.readUInt32BE(at);
    const type = file.toString('latin1', at + 4, at + 8);
    const body = file.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR') [width, height, channels, bytes] = [body.readUInt32BE(0), body.readUInt32BE(4), { 0: 1, 2: 3, 6: 4 }[body[9]!]!, body[8]! / 8];
    if (type === 'IDAT') data.push(body);
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(data));
  const pixel = Math.ceil(channels * bytes);
  const stride = Math.ceil(width * channels * bytes);
  const lines = Buffer.alloc(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)]!;
    for (let x = 0; x < stride; ++x) {
      const left = x >= pixel ? lines[y * stride + x - pixel]! : 0;
      const up = y > 0 ? lines[(y - 1) * stride + x]! : 0;
      const corner = x >= pixel && y > 0 ? lines[(y - 1) * stride + x - pixel]! : 0;
      const p = left + up - corner;
      const [a, b, c] = [Math.abs(p - left), Math.abs(p - up), Math.abs(p - corner)];
      const paeth = a <= b && a <= c ? left : b <= c ? up : corner;
      lines[y * stride + x] = raw[y * (stride + 1) + 1 + x]! + [0, left, up, (left + up) >> 1, paeth][filter]!;
    }
  }
  if (bytes < 1) return { width, height, channels, samples: Uint16Array.from({ length: width * height }, (_, i) => (lines[Math.floor(i / width) * stride + ((i % width) >> 3)]! >> (7 - ((i % width) & 7))) & 1) };
  return { width, height, channels, samples: Uint16Array.from({ length: width * height * channels }, (_, i) => (bytes === 2 ? lines.readUInt16BE(2 * i) : lines[i]!)) };
}
