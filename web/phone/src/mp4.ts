// Finds the images in an MP4 or MOV file: their places in the file, their times, the decoder's settings, the rotation.
// A bundle of its own (mp4.js), which the page loads when such a file is opened.
import { createFile, MP4BoxBuffer } from 'mp4box';

// Matrix of the display (ISO/IEC 14496-12, 8.3.2): x' = a x + c y, y' = b x + d y.
export interface Turn { a: number; b: number; c: number; d: number }

// In decoding order.
export interface Samples {
  offset: Float64Array; // in the file, bytes
  size: Uint32Array; // bytes
  time: Float64Array; // of presentation, seconds; NaN: decoded but not shown
  key: Uint8Array; // 1: decodable without earlier ones
}

export interface Mp4 {
  config: VideoDecoderConfig;
  samples: Samples;
  turn: Turn;
  duration: number; // seconds
}

interface Edit { segment_duration: number; media_time: number; media_rate_integer: number; media_rate_fraction: number }
interface Configuration { start: number; hdr_size: number; size: number }

const LARGEST = 2 ** 28; // bytes of a box other than the images: an index of hours takes some MB
const FIXED = 65536; // 16.16 numbers

// Throws Error if the file has a form that a player, but not this function, understands. Reads only the index, not the
// images.
export async function readMp4(file: Blob): Promise<Mp4> {
  const parsed = createFile();
  let problem = '';
  parsed.onError = (_module: string, text: string) => { problem ||= text; };
  let at = 0;
  const append = async (length: number) => {
    parsed.appendBuffer(MP4BoxBuffer.fromArrayBuffer(await file.slice(at, at + length).arrayBuffer(), at));
  };
  while (at + 8 <= file.size) {
    const box = boxAt(new DataView(await file.slice(at, at + 16).arrayBuffer()), file.size - at);
    if (box.size > LARGEST && box.type !== 'mdat') throw new Error(`its box ${box.type} has ${box.size} bytes`);
    await append(box.type === 'mdat' ? box.header : box.size);
    at += box.size;
  }
  parsed.flush();
  if (problem) throw new Error(problem);
  if (!parsed.moov) throw new Error('it has no index (moov)');
  const track = parsed.getInfo().videoTracks.sort((a, b) => b.nb_samples - a.nb_samples)[0];
  const box = track && parsed.getTrackById(track.id);
  const list = track && parsed.getTrackSamplesInfo(track.id);
  if (!track?.video || !box || !list?.length) throw new Error('it contains no images');
  if (list.some(({ description_index }) => description_index !== list[0]!.description_index)) throw new Error('its format changes');

  const shown = presentation((box as unknown as { edts?: { elst?: { entries: Edit[] } } }).edts?.elst?.entries ?? [], track.movie_timescale, track.timescale);
  const samples: Samples = { offset: new Float64Array(list.length), size: new Uint32Array(list.length), time: new Float64Array(list.length), key: new Uint8Array(list.length) };
  let duration = 0;
  list.forEach(({ offset, size, cts, duration: ticks, is_sync }, i) => {
    const time = shown(cts);
    samples.offset[i] = offset;
    samples.size[i] = size;
    samples.time[i] = time;
    samples.key[i] = Number(is_sync);
    if (!Number.isNaN(time)) duration = Math.max(duration, time + ticks / track.timescale);
  });
  const entry = list[0]!.description as unknown as Record<'avcC' | 'hvcC', Configuration | undefined>;
  const own = entry.avcC ?? entry.hvcC; // VP9 and AV1 have all of it in their images
  const description = own && await file.slice(own.start + own.hdr_size, own.start + own.size).arrayBuffer();
  const { width, height } = track.video;
  return { config: { codec: track.codec, codedWidth: width, codedHeight: height, ...(description ? { description } : {}) }, samples, turn: turnOf(box.tkhd.matrix), duration };
}

function boxAt(view: DataView, rest: number): { type: string; header: number; size: number } {
  const type = String.fromCharCode(...[4, 5, 6, 7].map((i) => view.getUint8(i)));
  const short = view.getUint32(0);
  if (short === 0) return { type, header: 8, size: rest }; // up to the end of the file
  const long = short === 1 && view.byteLength >= 16;
  const [header, size] = long ? [16, Number(view.getBigUint64(8))] : [8, short];
  if (size < header) throw new Error(`its box ${type} has ${size} bytes`);
  return { type, header, size };
}

// Time in seconds at which an image of a composition time (in the track's ticks) is shown, by the edit list
// (ISO/IEC 14496-12, 8.6.6).
function presentation(edits: readonly Edit[], movieScale: number, trackScale: number): (composition: number) => number {
  if (edits.length === 0) return (composition) => composition / trackScale;
  let begin = 0;
  let last = -1;
  const parts = edits.map(({ segment_duration, media_time, media_rate_integer, media_rate_fraction }) => {
    const part = { begin, from: media_time, to: media_time + (segment_duration > 0 ? (segment_duration * trackScale) / movieScale : Infinity) };
    begin += segment_duration / movieScale;
    if (media_time < 0) return { ...part, to: -Infinity }; // nothing is shown
    if (media_rate_integer !== 1 || media_rate_fraction !== 0 || media_time < last) throw new Error('its edit list repeats images or changes their speed');
    last = part.to;
    return part;
  });
  return (composition) => {
    const part = parts.find(({ from, to }) => composition >= from && composition < to);
    return part ? part.begin + (composition - part.from) / trackScale : NaN;
  };
}

// Quarter turns and mirrors; players ignore other matrices.
function turnOf(matrix: ArrayLike<number>): Turn {
  const [a, b, c, d] = [matrix[0]!, matrix[1]!, matrix[3]!, matrix[4]!].map((value) => (value | 0) / FIXED) as [number, number, number, number];
  const whole = [a, b, c, d].every((value) => Math.abs(value) === 1 || value === 0) && Math.abs(a * d - b * c) === 1;
  return whole ? { a, b, c, d } : { a: 1, b: 0, c: 0, d: 1 };
}
