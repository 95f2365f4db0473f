// Engine on the computer that serves the page: sends images as JPEGs and receives results (docs/reference/phone-protocol.md). At most
// IN_FLIGHT images are unanswered; control.ts then skips to the newest.
import { failureWithReason, FAILURES, REASONS } from '../../scene/src/failures.ts';
import type { Frame, Pose, State } from '../../core/src/index.ts';
import type { Engine, Hooks } from './engine.ts';
import type { Saved, Start } from './protocol.ts';

const IN_FLIGHT = 2;
const QUALITY = 0.8; // JPEG quality
const AGAIN = [500, 1000, 2000, 4000]; // milliseconds between connection attempts
// Milliseconds without a due reply before the connection is given up, because browsers take minutes to detect a lost
// network.
const PATIENCE = 8000;
const MOST_BUFFERED = 1 << 20; // bytes not yet sent by the browser; beyond this, images are skipped

interface Told {
  welcome?: boolean; last?: number; resumed?: boolean; error?: string;
  frame?: number; state?: string; failure?: string | null; reason?: string; milliseconds?: number; skipped?: boolean;
  keyframes?: number; landmarks?: number; matches?: number; features?: number; fov?: number; fovSigma?: number; pose?: number[] | null; predicted?: number[] | null;
}

export class RemoteEngine implements Engine {
  private readonly session = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
  private socket: WebSocket | null = null;
  private open = false;
  private over = false;
  private tries = 0;
  private number = 0;
  private compressing = 0;
  private patience = 0; // timer
  private start: Omit<Start, 'kind' | 'base' | 'threads'> | null = null;
  private readonly sent = new Map<number, { time: number; bitmap: ImageBitmap; turn: number }>();
  private pending: Uint8Array[] = []; // messages since the last frame's result
  private begun: { resolve(): void; reject(error: Error): void } | null = null;

  constructor(private readonly hooks: Hooks) {}

  get free(): boolean {
    return this.open && this.compressing === 0 && this.sent.size < IN_FLIGHT && (this.socket?.bufferedAmount ?? 0) < MOST_BUFFERED;
  }

  get idle(): boolean { return this.compressing === 0 && this.sent.size === 0; }

  begin(start: Omit<Start, 'kind' | 'base' | 'threads'>): Promise<void> {
    this.start = start;
    return new Promise((resolve, reject) => {
      this.begun = { resolve, reject };
      this.connect();
    });
  }

  push(bitmap: ImageBitmap, time: number, turn: number): void {
    ++this.compressing;
    void this.send(bitmap, time, turn).finally(() => { --this.compressing; });
  }

  ask(what: Saved): Promise<Uint8Array<ArrayBuffer>> {
    if (what === 'finish') return Promise.resolve(new Uint8Array());
    return Promise.reject(new Error('it is on the computer that serves this page'));
  }

  close(): void {
    this.over = true;
    clearTimeout(this.patience);
    this.socket?.close();
    for (const { bitmap } of this.sent.values()) bitmap.close();
    this.sent.clear();
  }

  private async send(bitmap: ImageBitmap, time: number, turn: number): Promise<void> {
    const { width, height } = this.start!;
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext('2d')!;
    context.translate(width / 2, height / 2);
    context.rotate((turn * Math.PI) / 2);
    const [w, h] = turn % 2 ? [height, width] : [width, height];
    context.drawImage(bitmap, -w / 2, -h / 2, w, h);
    const jpeg = await (await canvas.convertToBlob({ type: 'image/jpeg', quality: QUALITY })).arrayBuffer();
    // The connection was lost during compression; newer images will follow. Sending on a closing socket only logs an
    // error, and `onclose`, which resets `open`, is called later.
    if (!this.open || this.socket?.readyState !== WebSocket.OPEN) return bitmap.close();
    const number = this.number++;
    const head = new DataView(new ArrayBuffer(16));
    head.setUint32(0, number, true);
    head.setFloat64(8, time, true);
    this.sent.set(number, { time, bitmap, turn });
    this.socket.send(new Blob([head.buffer, jpeg]));
    if (this.sent.size === 1) this.wait();
  }

  // Starts the timeout for a due reply; after PATIENCE the connection is given up.
  private wait(owed = this.sent.size > 0): void {
    clearTimeout(this.patience);
    if (owed) this.patience = window.setTimeout(() => this.drop(), PATIENCE);
  }

  // Closes the socket without waiting for the closing handshake, because the other side may be unreachable.
  private drop(): void {
    const { socket } = this;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
    this.closed();
  }

  private connect(): void {
    const address = new URL('frames', document.baseURI);
    address.protocol = address.protocol.replace('http', 'ws');
    address.search = location.search;
    const socket = new WebSocket(address);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    this.wait(true);
    socket.onopen = () => {
      const { width, height, fov } = this.start!;
      socket.send(JSON.stringify({ session: this.session, width, height, fov }));
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === 'string') this.hear(JSON.parse(data) as Told);
      else this.pending.push(new Uint8Array(data));
      if (typeof data !== 'string' && this.sent.size === 0) this.flush();
      this.wait();
    };
    socket.onclose = () => this.closed();
  }

  private closed(): void {
    this.open = false;
    clearTimeout(this.patience);
    // It is unknown whether they arrived; newer ones follow.
    for (const { bitmap } of this.sent.values()) bitmap.close();
    this.sent.clear();
    this.pending = []; // the whole state follows
    if (this.over) return;
    this.hooks.lost('No connection to the computer that serves this page. Trying again …');
    setTimeout(() => { if (!this.over) this.connect(); }, AGAIN[Math.min(this.tries++, AGAIN.length - 1)]);
  }

  private hear(told: Told): void {
    if (told.error !== undefined) {
      this.over = true;
      this.socket?.close();
      if (this.begun) this.begun.reject(new Error(told.error));
      else this.hooks.failed(told.error);
      this.begun = null;
      return;
    }
    if (told.welcome) {
      this.open = true;
      this.tries = 0;
      if (!this.begun && told.resumed !== true) this.hooks.anew();
      this.number = Math.max(this.number, (told.last ?? -1) + 1);
      this.hooks.lost('');
      this.begun?.resolve();
      this.begun = null;
      return;
    }
    const sent = told.frame === undefined ? undefined : this.sent.get(told.frame);
    if (!sent) return;
    this.sent.delete(told.frame!);
    if (told.skipped) return sent.bitmap.close();
    const messages = this.pending;
    this.pending = [];
    this.hooks.done({
      kind: 'done', number: told.frame!, time: sent.time, light: NaN, messages, bitmap: sent.bitmap, turn: sent.turn, inertial: null, spreads: {},
      frame: {
        number: told.frame!, state: stateFrom(told.state), ...failureFrom(told), pose: poseFrom(told.pose), predicted: poseFrom(told.predicted),
        counts: { keyframes: told.keyframes ?? 0, landmarks: told.landmarks ?? 0, matches: told.matches ?? 0, features: told.features ?? 0, maps: 0 },
        milliseconds: told.milliseconds ?? 0, fov: told.fov ?? 0, fovSigma: told.fovSigma ?? 0, cameraChanges: 0, orientation: null,
      },
    });
  }

  private flush(): void {
    const messages = this.pending;
    this.pending = [];
    this.hooks.messages(messages);
  }
}

// Programs of version 0.1 say 'initialising'.
function stateFrom(told: string | undefined): State {
  return told === 'tracking' ? told : told === 'initializing' || told === 'initialising' ? 'initializing' : 'lost';
}

// Programs of version 0.1 send words only.
function failureFrom({ failure, reason = '' }: Told): Pick<Frame, 'failure' | 'reason'> {
  const found = FAILURES.find((one) => one === failure) ?? failureWithReason(reason);
  return { failure: found, reason: found ? REASONS[found] : reason };
}

// Seven numbers: quaternion x y z w, position.
function poseFrom(numbers: number[] | null | undefined): Pose | null {
  return numbers
    ? { position: [numbers[4]!, numbers[5]!, numbers[6]!], orientation: [numbers[0]!, numbers[1]!, numbers[2]!, numbers[3]!] }
    : null;
}
