// Images of the camera, as long as it is open.
import { holdFocus, openCamera } from './camera.ts';

export interface CameraEvents {
  // A new image is displayed; seconds of its own clock, and when it was taken by that of the page (performance.now()).
  image(time: number, at: number): void;
  problem(text: string): void; // the camera could not be reopened; '': it was
}

export class CameraSource {
  focusHeld = false;
  private last = -1; // time of the last image, seconds
  private grab: { canvas: OffscreenCanvas; context: OffscreenCanvasRenderingContext2D } | null = null;
  // Screen rotation in degrees, and whether the image was in portrait orientation, at the start.
  private readonly angle = screen.orientation?.angle ?? 0;
  private readonly upright: boolean;

  private constructor(private readonly video: HTMLVideoElement, private stream: MediaStream | null, private readonly events: CameraEvents) {
    this.upright = video.videoHeight > video.videoWidth;
    this.watch();
  }

  // Throws CameraProblem with a text for users.
  static async open(video: HTMLVideoElement, events: CameraEvents): Promise<CameraSource> {
    const stream = await openCamera();
    try {
      video.srcObject = stream;
      await video.play();
    } catch (error) {
      for (const track of stream.getTracks()) track.stop();
      video.srcObject = null;
      throw error;
    }
    return new CameraSource(video, stream, events);
  }

  // Begins to report images.
  start(focus: boolean): void {
    if (focus && this.stream) void holdFocus(this.stream).then((held) => { this.focusHeld = held; });
    this.video.requestVideoFrameCallback(this.take);
  }

  // The displayed image.
  image(): ImageBitmap {
    const { videoWidth: width, videoHeight: height } = this.video;
    if (!this.grab || this.grab.canvas.width !== width || this.grab.canvas.height !== height) {
      const canvas = new OffscreenCanvas(width, height);
      this.grab = { canvas, context: canvas.getContext('2d')! };
    }
    this.grab.context.drawImage(this.video, 0, 0, width, height);
    return this.grab.canvas.transferToImageBitmap();
  }

  // Browsers rotate the camera image with the phone. Returns the clockwise quarter turns that undo this, so that the
  // lens model remains valid.
  turned(): number {
    const quarters = Math.round(((screen.orientation?.angle ?? 0) - this.angle) / 90) & 3;
    const changed = (this.video.videoHeight > this.video.videoWidth) !== this.upright;
    if (changed) return quarters % 2 ? quarters : 1;
    return quarters === 2 ? 2 : 0;
  }

  // Call when the page becomes visible again: the system may have taken the camera meanwhile.
  resume(): void {
    if (this.stream?.getVideoTracks()[0]?.readyState !== 'live') void this.reopen();
    else void this.video.play().catch(() => {});
  }

  close(): void {
    for (const track of this.stream?.getTracks() ?? []) track.stop();
    if (this.stream) this.video.srcObject = null;
    this.stream = null;
  }

  private readonly take: VideoFrameRequestCallback = (now, { mediaTime, captureTime, presentationTime }) => {
    if (!this.stream) return;
    this.video.requestVideoFrameCallback(this.take);
    const time = mediaTime > 0 ? mediaTime : now / 1000;
    if (time <= this.last) return;
    this.last = time;
    this.events.image(time, (captureTime ?? presentationTime ?? now) / 1000);
  };

  private watch(): void {
    this.stream?.getVideoTracks()[0]?.addEventListener('ended', () => {
      if (this.stream && document.visibilityState === 'visible') void this.reopen();
    });
  }

  // The map is kept, and the camera relocalizes.
  private async reopen(): Promise<void> {
    if (!this.stream) return;
    try {
      this.stream = await openCamera();
      this.watch();
      this.video.srcObject = this.stream;
      await this.video.play();
      this.video.requestVideoFrameCallback(this.take);
      this.events.problem('');
    } catch (error) {
      this.events.problem((error as Error).message);
    }
  }
}
