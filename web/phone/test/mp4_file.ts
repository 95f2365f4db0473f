// Writes MP4 files with one video track (ISO/IEC 14496-12), for tests.

export interface Sample { data: Uint8Array; key: boolean; delay?: number } // `delay`: composition minus decoding time, ticks
export interface Layout {
  width: number; height: number;
  entry: 'vp09' | 'avc1';
  configuration: Uint8Array; // content of vpcC or avcC
  matrix?: readonly [a: number, b: number, c: number, d: number];
  edits?: readonly { duration: number; from: number }[]; // ticks of a millisecond; ticks of the track
}

export const TICKS = 30; // one image each, so 30 images per second

const number = (bytes: number) => (...values: number[]) => {
  const out = new Uint8Array(bytes * values.length);
  const view = new DataView(out.buffer);
  values.forEach((value, i) => {
    if (bytes === 4) view.setUint32(4 * i, value >>> 0);
    else if (bytes === 2) view.setUint16(2 * i, value);
    else out[i] = value;
  });
  return out;
};
const [u8, u16, u32] = [number(1), number(2), number(4)];

function joined(parts: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const out = new Uint8Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

function box(type: string, ...content: Uint8Array[]): Uint8Array {
  const body = joined(content);
  return joined([u32(body.length + 8), new TextEncoder().encode(type), body]);
}

const identity = (a = 1, b = 0, c = 0, d = 1) => u32(a * 65536, b * 65536, 0, c * 65536, d * 65536, 0, 0, 0, 2 ** 30);

// The samples lie at `first`, each of `gap` bytes more than its data. Index of the file: moov.
export function index(samples: readonly Sample[], { width, height, entry, configuration, matrix = [1, 0, 0, 1], edits = [] }: Layout, first: number, gap = 0): Uint8Array {
  const place = samples.map((_, i) => first + samples.slice(0, i).reduce((sum, { data }) => sum + data.length + gap, 0));
  const length = (1000 * samples.length) / TICKS;
  const visual = box(entry, u8(0, 0, 0, 0, 0, 0), u16(1), new Uint8Array(16), u16(width, height), u32(72 << 16, 72 << 16, 0), u16(1), new Uint8Array(32), u16(24, 0xffff),
    box(entry === 'vp09' ? 'vpcC' : 'avcC', configuration));
  return box('moov',
    box('mvhd', u32(0, 0, 0, 1000, length, 65536), u16(256, 0), u32(0, 0), identity(), new Uint8Array(24), u32(2)),
    box('trak',
      box('tkhd', u32(7, 0, 0, 1, 0, length, 0, 0), u16(0, 0, 0, 0), identity(...matrix), u32(width << 16, height << 16)),
      ...(edits.length ? [box('edts', box('elst', u32(0, edits.length), ...edits.map(({ duration, from }) => u32(duration, from, 65536))))] : []),
      box('mdia',
        box('mdhd', u32(0, 0, 0, TICKS, samples.length), u16(0x55c4, 0)),
        box('hdlr', u32(0, 0), new TextEncoder().encode('vide'), u32(0, 0, 0), u8(0)),
        box('minf', box('vmhd', u32(1, 0, 0)), box('dinf', box('dref', u32(0, 1), box('url ', u32(1)))),
          box('stbl', box('stsd', u32(0, 1), visual), box('stts', u32(0, 1, samples.length, 1)),
            box('ctts', u32(0, samples.length, ...samples.flatMap(({ delay = 0 }) => [1, delay]))),
            box('stss', u32(0, samples.filter(({ key }) => key).length, ...samples.flatMap(({ key }, i) => (key ? [i + 1] : [])))),
            box('stsc', u32(0, 1, 1, 1, 1)), box('stsz', u32(0, 0, samples.length, ...samples.map(({ data }) => data.length))),
            box('stco', u32(0, samples.length, ...place)))))));
}

export const FTYP = box('ftyp', new TextEncoder().encode('isom'), u32(512), new TextEncoder().encode('isomiso2mp41'));

// A whole file; its index comes last, as cameras write it.
export function mp4File(samples: readonly Sample[], layout: Layout): Uint8Array<ArrayBuffer> {
  return joined([FTYP, box('mdat', ...samples.map(({ data }) => data)), index(samples, layout, FTYP.length + 8)]);
}

// Begin of a box `mdat` with a 64-bit length.
export function longMdat(bytes: number): Uint8Array { return joined([u32(1), new TextEncoder().encode('mdat'), u32(0, bytes + 16)]); }
