// The core's Worker: scales each image, passes it to the core and returns the result.
import { Slam } from '../../core/src/index.ts';
import type { FromDetector, FromWorker, Look, Picture, Start, ToWorker } from './protocol.ts';

const scope = self as unknown as { postMessage(message: FromWorker, transfer: Transferable[]): void; onmessage: ((event: MessageEvent<ToWorker>) => void) | null };

let slam: Slam | null = null;
let context: OffscreenCanvasRenderingContext2D | null = null;

let detector: MessagePort | null = null;
let detectorFree = true;

async function start({ base, threads, width, height, fov, settings, classes }: Start): Promise<void> {
  slam = await Slam.create({ width, height, base, threads, settings, classes, ...(fov ? { fov } : {}) });
  context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  scope.postMessage({ kind: 'ready' }, []);
}

function track({ number, time, bitmap, turn, imu, ends }: Picture): void {
  if (!slam || !context) return;
  const { width, height } = slam;
  context.setTransform(1, 0, 0, 1, 0, 0);
  if (turn === 0) {
    context.drawImage(bitmap, 0, 0, width, height);
  } else {
    context.translate(width / 2, height / 2);
    context.rotate((turn * Math.PI) / 2);
    const [w, h] = turn % 2 ? [height, width] : [width, height];
    context.drawImage(bitmap, -w / 2, -h / 2, w, h);
  }
  const image = context.getImageData(0, 0, width, height);
  const frame = slam.track(time, image, imu);
  const told = slam.inertial();
  const inertial = told.samples > 0 ? told : null;
  const spreads = Object.fromEntries(ends.map((id) => [id, slam!.landmarkCovariance(id)]));
  const messages = slam.messages();
  scope.postMessage({ kind: 'done', number, time, frame, light: meanGreen(image.data), messages, bitmap, turn, inertial, spreads }, [bitmap, ...messages.map(({ buffer }) => buffer)]);
  if (!detector || !detectorFree) return;
  detectorFree = false;
  detector.postMessage({ number: frame.number, width, height, pixels: image.data.buffer } satisfies Look, [image.data.buffer]);
}

// Called between two images.
function connect(port: MessagePort): void {
  detector = port;
  port.onmessage = ({ data }: MessageEvent<FromDetector>) => {
    if (data.kind === 'free') detectorFree = true;
    else slam?.detected(data.number, data.found);
  };
}

// Mean of every 16th pixel's green channel, to detect dark images.
function meanGreen(data: Uint8ClampedArray): number {
  let sum = 0;
  for (let i = 1; i < data.length; i += 64) sum += data[i]!;
  return sum / (data.length / 64);
}

scope.onmessage = ({ data }) => {
  const failed = (error: unknown) => scope.postMessage({ kind: 'failed', error: error instanceof Error ? error.message : String(error), ...(data.kind === 'ask' ? { what: data.what } : {}) }, []);
  if (data.kind === 'prepare') return void Slam.prepare(data).then(() => scope.postMessage({ kind: 'prepared' }, []), () => {}); // start says what fails
  if (data.kind === 'start') return void start(data).catch(failed);
  try {
    if (data.kind === 'picture') return track(data);
    if (data.kind === 'detector') return connect(data.port);
    if (!slam) return;
    if (data.what === 'finish') slam.finish();
    const bytes = data.what === 'map' ? slam.map() : data.what === 'cloud' ? slam.cloud() : new TextEncoder().encode(data.what === 'trajectory' ? slam.trajectory() : '');
    scope.postMessage({ kind: 'answer', what: data.what, bytes: bytes as Uint8Array<ArrayBuffer>, messages: data.what === 'finish' ? slam.messages() : [] }, [bytes.buffer]);
  } catch (error) {
    failed(error);
  }
};
