// Plays a video file and captures each image: for what decoded_video.ts cannot decode. A busy machine may miss images.
import type { Picture, Video } from './video.ts';

const MOST_WAITING = 3; // images
const SLOWEST = 0.0625, FASTEST = 4; // playback rates supported by browsers
const STEADY = 30; // images without a miss before playback speeds up

// Plays a video element and captures each displayed image. When one was missed (the browser counts displayed images),
// seeks back and plays more slowly.
export class PlayedVideo implements Video {
  private readonly address: string;
  private readonly canvas: OffscreenCanvas;
  private readonly context: OffscreenCanvasRenderingContext2D;
  private waiting: Picture[] = [];
  private last = -1; // time of the last captured image, seconds
  private shown = -1; // images displayed so far, as counted by the browser
  private dropped = 0;
  private steady = 0;
  private closed = false;
  private wake: (() => void) | null = null;

  private constructor(private readonly video: HTMLVideoElement, address: string) {
    this.address = address;
    this.canvas = new OffscreenCanvas(video.videoWidth, video.videoHeight);
    this.context = this.canvas.getContext('2d')!;
  }

  // Throws Error with a text for users when the browser cannot read the file.
  static async open(video: HTMLVideoElement, file: Blob): Promise<PlayedVideo> {
    const address = URL.createObjectURL(file);
    await new Promise<void>((resolve, reject) => {
      video.onloadeddata = () => resolve();
      video.onerror = () => reject(new Error('this browser cannot read it as a video (MP4 with H.264 and WebM work in nearly all browsers)'));
      video.srcObject = null;
      video.src = address;
      video.load();
    });
    if (!video.videoWidth) throw new Error('it contains no images');
    const opened = new PlayedVideo(video, address);
    video.playbackRate = 0.5;
    video.requestVideoFrameCallback(opened.take);
    video.onended = () => opened.wake?.();
    return opened;
  }

  get width(): number { return this.canvas.width; }
  get height(): number { return this.canvas.height; }
  get duration(): number { return this.video.duration; }

  // The next image and its time in seconds; null: end of the video.
  async next(): Promise<Picture | null> {
    for (;;) {
      const first = this.waiting.shift();
      if (this.closed) return null;
      if (first && this.waiting.length > 0) return first;
      if (this.video.ended) return first ?? null;
      if (this.video.paused) await this.video.play().catch(() => { this.closed = true; });
      if (first) return first;
      await new Promise<void>((resolve) => { this.wake = resolve; });
      this.wake = null;
    }
  }

  close(): void {
    if (this.closed) return;
    this.closed = true;
    for (const { bitmap } of this.waiting) bitmap.close();
    this.waiting = [];
    this.video.pause();
    this.video.removeAttribute('src');
    this.video.load();
    URL.revokeObjectURL(this.address);
    this.wake?.();
  }

  private readonly take = (_: number, { mediaTime, presentedFrames }: VideoFrameCallbackMetadata): void => {
    if (this.closed) return;
    const { video } = this;
    video.requestVideoFrameCallback(this.take);
    const { droppedVideoFrames } = video.getVideoPlaybackQuality();
    const missed = this.shown >= 0 && (presentedFrames > this.shown + 1 || droppedVideoFrames > this.dropped);
    this.shown = presentedFrames;
    this.dropped = droppedVideoFrames;
    if (mediaTime <= this.last) return;
    if (missed && video.playbackRate > SLOWEST) {
      this.steady = 0;
      video.playbackRate = Math.max(SLOWEST, 0.6 * video.playbackRate);
      video.currentTime = Math.max(0, this.last);
      this.shown = -1;
      return;
    }
    if (++this.steady > STEADY && this.waiting.length === 0) {
      this.steady = 0;
      video.playbackRate = Math.min(FASTEST, 1.2 * video.playbackRate);
    }
    this.last = mediaTime;
    this.context.drawImage(video, 0, 0);
    this.waiting.push({ bitmap: this.canvas.transferToImageBitmap(), time: mediaTime });
    if (this.waiting.length >= MOST_WAITING) video.pause();
    this.wake?.();
  };
}
