// The computer that serves the page does the work: pictures go there as JPEGs, what it tells comes back (docs/reference/phone-protocol.md).
// At most IN_FLIGHT pictures are on their way; of those that come meanwhile only the newest is sent, by main.ts.
import type { Frame } from '../../core/src/index.ts';
import type { Engine, Hooks } from './engine.ts';
import type { Saved, Start } from './protocol.ts';

const IN_FLIGHT = 2;
const QUALITY = 0.8;            // of the JPEGs
const AGAIN = [500, 1000, 2000, 4000]; // milliseconds between tries to connect
const PATIENCE = 8000;          // milliseconds without a sign of the computer that owes one: browsers take minutes to see that a network is gone
const MOST_BUFFERED = 1 << 20;  // bytes that the browser has not sent yet: beyond, pictures are left out

interface Told {
  welcome?: boolean; last?: number; resumed?: boolean; error?: string;
  frame?: number; state?: Frame['state']; reason?: string; milliseconds?: number; skipped?: boolean;
  keyframes?: number; landmarks?: number; matches?: number; features?: number; fov?: number; fovSigma?: number; pose?: number[] | null;
}

export class RemoteEngine implements Engine {
  private readonly session = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
  private socket: WebSocket | null = null;
  private open = false;
  private over = false;
  private tries = 0;
  private number = 0;
  private compressing = 0;
  private patience = 0; // the timer
  private start: Omit<Start, 'kind' | 'base' | 'threads'> | null = null;
  private readonly sent = new Map<number, { time: number; bitmap: ImageBitmap; turn: number }>();
  private pending: Uint8Array[] = []; // messages since the last frame's text
  private other = false; // the next hello is of another map than the one that is known
  private begun: { resolve(): void; reject(error: Error): void } | null = null;

  constructor(private readonly hooks: Hooks) {}

  get free(): boolean {
    return this.open && this.compressing === 0 && this.sent.size < IN_FLIGHT && (this.socket?.bufferedAmount ?? 0) < MOST_BUFFERED;
  }

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
    return Promise.reject(new Error('it is on the computer that does the work'));
  }

  // A hello has come: whether the map that was there before the connection was lost is gone.
  beginsAnew(): boolean {
    const { other } = this;
    this.other = false;
    return other;
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
    // The network went while this was compressed: there will be newer ones. A socket that is closing takes nothing, and
    // says so in the console; its `onclose`, which clears `open`, comes later.
    if (!this.open || this.socket?.readyState !== WebSocket.OPEN) return bitmap.close();
    const number = this.number++;
    const head = new DataView(new ArrayBuffer(16));
    head.setUint32(0, number, true);
    head.setFloat64(8, time, true);
    this.sent.set(number, { time, bitmap, turn });
    this.socket.send(new Blob([head.buffer, jpeg]));
    if (this.sent.size === 1) this.wait();
  }

  // Until something is heard, which `owed` says there should be; nothing within PATIENCE: the connection is given up.
  private wait(owed = this.sent.size > 0): void {
    clearTimeout(this.patience);
    if (owed) this.patience = window.setTimeout(() => this.drop(), PATIENCE);
  }

  // Without waiting for the good-bye of one that may be gone.
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
    for (const { bitmap } of this.sent.values()) bitmap.close(); // unknown whether they came: newer ones follow
    this.sent.clear();
    this.pending = []; // the whole follows
    if (this.over) return;
    this.hooks.lost('No connection to the computer that does the work. Trying again …');
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
      this.other = told.resumed !== true;
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
    const pose = told.pose ?? null;
    const messages = this.pending;
    this.pending = [];
    this.hooks.done({
      kind: 'done', number: told.frame!, time: sent.time, light: NaN, messages, bitmap: sent.bitmap, turn: sent.turn,
      frame: {
        number: told.frame!, state: told.state ?? 'lost', reason: told.reason ?? '', predicted: false,
        pose: pose && { position: [pose[4]!, pose[5]!, pose[6]!], orientation: [pose[0]!, pose[1]!, pose[2]!, pose[3]!] },
        counts: { keyframes: told.keyframes ?? 0, landmarks: told.landmarks ?? 0, matches: told.matches ?? 0, features: told.features ?? 0, maps: 0 },
        milliseconds: told.milliseconds ?? 0, fov: told.fov ?? 0, fovSigma: told.fovSigma ?? 0, cameraChanges: 0,
      },
    });
  }

  private flush(): void {
    const messages = this.pending;
    this.pending = [];
    this.hooks.messages(messages);
  }
}
