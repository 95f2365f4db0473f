// Decodes the images of an MP4 or MOV file with WebCodecs, as fast as they are asked for. Memory is bounded: it reads and
// decodes only a little ahead.
import type { Mp4, Samples, Turn } from './mp4.ts';
import type { Picture, Video } from './video.ts';

const AHEAD = 4; // images decoded, and images given to the decoder, before they are asked for
const CHUNK = 2 ** 20; // bytes read at once
const LONGEST = 1280; // pixels of a side; larger images are scaled, because the page shows and processes small ones
const FIRST_BOXES = ['ftyp', 'moov', 'mdat', 'wide', 'free', 'skip', 'pnot'];

export class DecodedVideo implements Video {
  readonly width: number;
  readonly height: number;
  readonly duration: number;
  private readonly canvas: OffscreenCanvas;
  private readonly context: OffscreenCanvasRenderingContext2D;
  private last = -1; // time of the last image, seconds

  private constructor(private readonly frames: Frames, private first: VideoFrame | null, { turn, duration }: Mp4) {
    const { displayWidth: w, displayHeight: h } = first!;
    const scale = Math.min(1, LONGEST / Math.max(w, h));
    const [width, height] = turn.a === 0 ? [h, w] : [w, h];
    this.width = Math.round(width * scale);
    this.height = Math.round(height * scale);
    this.duration = duration;
    this.canvas = new OffscreenCanvas(this.width, this.height);
    this.context = this.canvas.getContext('2d', { willReadFrequently: true })!; // the Worker reads it
    place(this.context, turn, this.width, this.height);
  }

  // Null: this browser or this file needs playback.
  static async open(file: Blob): Promise<DecodedVideo | null> {
    if (!('VideoDecoder' in self)) return null;
    const head = new TextDecoder('latin1').decode(await file.slice(4, 8).arrayBuffer());
    if (!FIRST_BOXES.includes(head)) return null;
    let frames: Frames | null = null;
    try {
      const address = new URL('mp4.js', document.baseURI).href;
      const { readMp4 } = await import(address) as typeof import('./mp4.ts');
      const found = await readMp4(file);
      if (!(await VideoDecoder.isConfigSupported(found.config)).supported) return null;
      frames = new Frames(file, found.config, found.samples);
      const first = await frames.next();
      if (first) return new DecodedVideo(frames, first, found);
    } catch (error) {
      console.debug(`not decoded but played: ${(error as Error).message}`);
    }
    frames?.close();
    return null;
  }

  async next(): Promise<Picture | null> {
    for (;;) {
      const frame = this.first ?? await this.frames.next();
      this.first = null;
      if (!frame) return null;
      const time = frame.timestamp / 1e6;
      const { context, canvas } = this;
      if (time > this.last) {
        const turned = context.getTransform().a === 0;
        context.drawImage(frame, 0, 0, turned ? this.height : this.width, turned ? this.width : this.height);
      }
      frame.close();
      if (time <= this.last) continue;
      this.last = time;
      return { bitmap: canvas.transferToImageBitmap(), time };
    }
  }

  close(): void {
    this.first?.close();
    this.first = null;
    this.frames.close();
  }
}

// Turns what is drawn at 0, 0 so that it fills the canvas.
function place(context: OffscreenCanvasRenderingContext2D, { a, b, c, d }: Turn, width: number, height: number): void {
  context.setTransform(a, b, c, d, a + c < 0 ? width : 0, b + d < 0 ? height : 0);
}

// Frames in order of presentation, with their times as timestamps.
class Frames {
  private readonly decoder: VideoDecoder;
  private readonly waiting: VideoFrame[] = [];
  private readonly hidden = new Set<number>(); // timestamps of frames that are not shown
  private ended = false;
  private problem: Error | null = null;
  private wakes: (() => void)[] = [];

  constructor(private readonly file: Blob, config: VideoDecoderConfig, private readonly samples: Samples) {
    this.decoder = new VideoDecoder({ output: (frame) => this.take(frame), error: (error) => this.stop(error) });
    this.decoder.ondequeue = () => this.wake();
    this.decoder.configure(config);
    void this.feed().catch((error: Error) => this.stop(error));
  }

  // The caller closes the frame. Null: the end.
  async next(): Promise<VideoFrame | null> {
    for (;;) {
      const frame = this.waiting.shift();
      if (frame) {
        this.wake();
        return frame;
      }
      if (this.problem) throw new Error(`the browser's decoder stopped: ${this.problem.message}`);
      if (this.ended) return null;
      await this.change();
    }
  }

  close(): void {
    this.ended = true;
    if (this.decoder.state !== 'closed') this.decoder.close();
    for (const frame of this.waiting.splice(0)) frame.close();
    this.wake();
  }

  private async feed(): Promise<void> {
    const { offset, size, time, key } = this.samples;
    const bytes = new Chunks(this.file);
    const begin = key.indexOf(1); // what comes before cannot be decoded
    for (let i = Math.max(0, begin); i < size.length && !this.ended; ++i) {
      while (!this.ended && (this.decoder.decodeQueueSize >= AHEAD || this.waiting.length >= AHEAD)) await this.change();
      if (offset[i]! + size[i]! > this.file.size) break; // the file is cut short
      const data = await bytes.read(offset[i]!, size[i]!);
      if (this.ended) return;
      const shown = !Number.isNaN(time[i]!);
      const timestamp = shown ? Math.round(1e6 * time[i]!) : -1 - i;
      if (!shown) this.hidden.add(timestamp);
      this.decoder.decode(new EncodedVideoChunk({ type: key[i] ? 'key' : 'delta', timestamp, data }));
    }
    if (this.ended) return;
    await this.decoder.flush();
    this.ended = true;
    this.wake();
  }

  private take(frame: VideoFrame): void {
    if (this.ended || this.hidden.delete(frame.timestamp)) return frame.close();
    this.waiting.push(frame);
    this.wake();
  }

  private stop(error: Error): void {
    if (this.ended) return;
    this.problem ??= error;
    this.ended = true;
    this.wake();
  }

  private change(): Promise<void> { return new Promise((resolve) => { this.wakes.push(resolve); }); }

  private wake(): void { for (const resolve of this.wakes.splice(0)) resolve(); }
}

// Reads a file in chunks, because images are small and follow one another.
class Chunks {
  private chunk = new Uint8Array();
  private from = 0;

  constructor(private readonly file: Blob) {}

  async read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    if (offset < this.from || offset + size > this.from + this.chunk.length) {
      this.chunk = new Uint8Array(await this.file.slice(offset, offset + Math.max(size, CHUNK)).arrayBuffer());
      this.from = offset;
    }
    return this.chunk.slice(offset - this.from, offset - this.from + size) as Uint8Array<ArrayBuffer>;
  }
}
