// Records the camera images as a TUM folder in a zip archive: rgb.txt and rgb/, motion.csv, device.json. Readable by
// `alidade run`.
import { Zip, ZipPassThrough, strToU8 } from 'fflate';

const QUALITY = 0.9; // JPEG quality
const MOST_BYTES = 1.5e9; // about 15 minutes; limited by the page's memory

export interface Device { userAgent: string; width: number; height: number; focusHeld: boolean; fov: number | null; began: string }

// camera.yaml of images of this size with a horizontal field of view in degrees.
export function cameraYaml(width: number, height: number, fov: number): string {
  const focal = width / (2 * Math.tan((fov * Math.PI) / 360));
  return `width: ${width}\nheight: ${height}\nfx: ${focal.toFixed(3)}\nfy: ${focal.toFixed(3)}\ncx: ${(width - 1) / 2}\ncy: ${(height - 1) / 2}\n`;
}

export class Recorder {
  readonly name: string;
  private readonly chunks: Blob[] = [];
  private readonly zip: Zip;
  private readonly canvas: OffscreenCanvas;
  private readonly context: OffscreenCanvasRenderingContext2D;
  private readonly lines: string[] = [];
  private readonly motion: string[] = [];
  private compressing = 0;
  private bytes_ = 0;
  private problem: Error | null = null;

  constructor(private readonly device: Device) {
    this.name = `alidade-${device.began.slice(0, 19).replace(/[:T]/g, '-')}`;
    this.canvas = new OffscreenCanvas(device.width, device.height);
    this.context = this.canvas.getContext('2d')!;
    this.zip = new Zip((error, data) => {
      if (error) this.problem = error;
      this.chunks.push(new Blob([data as Uint8Array<ArrayBuffer>])); // browsers store Blobs outside the page's memory
      this.bytes_ += data.length;
    });
    window.addEventListener('devicemotion', this.moved);
  }

  get bytes(): number { return this.bytes_; }
  get pictures(): number { return this.lines.length; }
  get full(): boolean { return this.bytes_ > MOST_BYTES; }

  // Skips the image while two earlier ones are still being compressed. `time`: seconds.
  add(picture: CanvasImageSource, time: number): void {
    if (this.compressing >= 2 || this.full) return;
    ++this.compressing;
    this.context.drawImage(picture, 0, 0, this.device.width, this.device.height);
    const number = this.lines.length;
    const name = `rgb/${String(number).padStart(6, '0')}.jpg`;
    this.lines.push(`${time.toFixed(6)} ${name}`);
    void this.canvas.convertToBlob({ type: 'image/jpeg', quality: QUALITY }).then(async (blob) => this.put(name, new Uint8Array(await blob.arrayBuffer())))
      .catch((error: Error) => { this.problem = error; }).finally(() => { --this.compressing; });
  }

  // Returns the archive. `camera`: content of camera.yaml; '' if unknown.
  async finish(camera: string): Promise<Blob> {
    window.removeEventListener('devicemotion', this.moved);
    while (this.compressing > 0) await new Promise((resolve) => { setTimeout(resolve, 10); });
    if (this.problem) throw this.problem;
    this.put('rgb.txt', strToU8('# seconds file\n' + this.lines.map((line) => line + '\n').join('')));
    this.put('motion.csv', strToU8('# seconds, acceleration with gravity x y z m/s^2, turning about x y z deg/s (W3C DeviceMotion: the device\'s own axes)\n' + this.motion.join('')));
    this.put('device.json', strToU8(JSON.stringify(this.device, null, 2) + '\n'));
    if (camera) this.put('camera.yaml', strToU8(camera));
    this.zip.end();
    return new Blob(this.chunks, { type: 'application/zip' });
  }

  private put(name: string, data: Uint8Array): void {
    const file = new ZipPassThrough(`${this.name}/${name}`);
    this.zip.add(file);
    file.push(data, true);
  }

  private readonly moved = ({ timeStamp, accelerationIncludingGravity: a, rotationRate: r }: DeviceMotionEvent): void => {
    const numbers = [a?.x, a?.y, a?.z, r?.beta, r?.gamma, r?.alpha].map((value) => (value ?? NaN).toFixed(5));
    this.motion.push(`${(timeStamp / 1000).toFixed(6)},${numbers.join(',')}\n`);
  };
}
