// Processes images: in a Worker of this page, or on the computer that serves the page (remote.ts).
import type { Done, FromWorker, Module, Saved, Start, ToWorker } from './protocol.ts';

export interface Hooks {
  done(result: Done): void;
  messages(messages: Uint8Array[]): void; // stream messages that do not belong to an image
  anew(): void; // messages of another map follow
  failed(error: string): void; // the session has ended
  lost(text: string): void; // the connection was lost and is being retried; '': restored
}

export interface Engine {
  readonly free: boolean; // ready for an image
  readonly idle: boolean; // no image is being processed or waiting
  begin(start: Omit<Start, 'kind' | 'base' | 'threads'>): Promise<void>;
  // `imu`: readings of the inertial sensor since the last image; `ends`: landmarks whose covariance is wanted.
  push(bitmap: ImageBitmap, time: number, turn: number, imu: Float64Array, ends: readonly number[]): void;
  ask(what: Saved): Promise<Uint8Array<ArrayBuffer>>; // rejects if unavailable
  close(): void;
}

const MOST_THREADS = 4;
const LONGEST_WAIT = 100; // milliseconds
const RECENT = 16; // images

// Images wait in the Worker's queue while one of them takes long (a new keyframe), as long as an image is expected to wait
// no longer than LONGEST_WAIT. A device that takes as long for every image gets the newest one when it is done.
export class LocalEngine implements Engine {
  private readonly worker = new Worker(new URL('worker.js', document.baseURI), { type: 'module' });
  private working = 0; // images sent and not yet answered
  private typical = LONGEST_WAIT; // milliseconds per image, mean of about RECENT
  private number = 0;
  private ready: (() => void) | null = null;
  private refuse: ((error: Error) => void) | null = null;
  private readonly waiting = new Map<Saved, { resolve(bytes: Uint8Array<ArrayBuffer>): void; reject(error: Error): void }>();

  // `threads`: the threaded module is available.
  constructor(private readonly hooks: Hooks, private readonly threads: boolean) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.hear(data);
    this.worker.onerror = (event) => this.fail(event.message || 'the Worker could not be started');
  }

  get free(): boolean { return this.ready === null && this.working * this.typical < LONGEST_WAIT; }

  get idle(): boolean { return this.working === 0; }

  // Loads the module before it is needed.
  prepare(): void { this.send({ kind: 'prepare', ...this.module() }); }

  async begin(start: Omit<Start, 'kind' | 'base' | 'threads'>): Promise<void> {
    await new Promise<void>((resolve, reject) => {
      this.ready = resolve;
      this.refuse = reject;
      this.send({ kind: 'start', ...this.module(), ...start });
    });
  }

  // Connects the Worker of a detector; may be called at any time after begin().
  connect(port: MessagePort): void { this.send({ kind: 'detector', port }, [port]); }

  push(bitmap: ImageBitmap, time: number, turn: number, imu: Float64Array, ends: readonly number[]): void {
    ++this.working;
    this.send({ kind: 'picture', number: this.number++, time, bitmap, turn, imu, ends }, [bitmap, imu.buffer as ArrayBuffer]);
  }

  ask(what: Saved): Promise<Uint8Array<ArrayBuffer>> {
    return new Promise((resolve, reject) => {
      this.waiting.set(what, { resolve, reject });
      this.send({ kind: 'ask', what });
    });
  }

  close(): void { this.worker.terminate(); }

  // Uses threads if the page is cross-origin isolated.
  private module(): Module {
    const cores = Math.min(MOST_THREADS, navigator.hardwareConcurrency || 1);
    const threads = self.crossOriginIsolated && cores > 1 && this.threads ? cores : 1;
    return { threads, base: new URL(threads > 1 ? 'core/threads/' : 'core/single/', document.baseURI).href };
  }

  private send(message: ToWorker, transfer: Transferable[] = []): void { this.worker.postMessage(message, transfer); }

  private hear(data: FromWorker): void {
    if (data.kind === 'prepared') {
      document.body.dataset.core = 'ready';
    } else if (data.kind === 'ready') {
      this.ready?.();
      this.ready = this.refuse = null;
    } else if (data.kind === 'done') {
      --this.working;
      this.typical += (data.frame.milliseconds - this.typical) / RECENT;
      this.hooks.done(data);
    } else if (data.kind === 'answer') {
      if (data.messages.length > 0) this.hooks.messages(data.messages);
      this.waiting.get(data.what)?.resolve(data.bytes);
      this.waiting.delete(data.what);
    } else if (data.what) {
      this.waiting.get(data.what)?.reject(new Error(data.error));
      this.waiting.delete(data.what);
    } else {
      this.fail(data.error);
    }
  }

  private fail(text: string): void {
    if (this.refuse) this.refuse(new Error(text));
    else this.hooks.failed(text);
    this.ready = this.refuse = null;
  }
}
