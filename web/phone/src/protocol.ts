// Messages between the page and its Workers.
import type { Frame, Inertial } from '../../core/src/index.ts';
import type { Spread } from './ruler.ts';

export interface Module {
  base: string; // folder of alidade.mjs
  threads: number; // 1: the module without threads
}
export interface Prepare extends Module { kind: 'prepare' } // loads the module in advance
export interface Start extends Module {
  kind: 'start';
  width: number; height: number; // of the processed images
  fov: number | null; // horizontal, degrees; null: self-calibrated
  settings: Record<string, string | number | boolean>;
  classes: readonly string[]; // of the detector; empty: none
}
// `port`: to the detector's Worker. It gets the newest image when it is free; its results may be late.
export interface Detector { kind: 'detector'; port: MessagePort }
// `turn`: clockwise quarter turns of the screen since the start, undone before processing. `imu`: readings of the inertial
// sensor since the last image (Slam.track()). `ends`: landmarks whose covariance is wanted.
export interface Picture { kind: 'picture'; number: number; time: number; bitmap: ImageBitmap; turn: number; imu: Float64Array; ends: readonly number[] }
export const SAVED = ['map', 'trajectory', 'cloud', 'finish'] as const;
export type Saved = (typeof SAVED)[number];
export interface Ask { kind: 'ask'; what: Saved }
export type ToWorker = Prepare | Start | Detector | Picture | Ask;

export interface Prepared { kind: 'prepared' }
export interface Ready { kind: 'ready' }
// `bitmap`: the image, returned; `light`: its mean gray level, 0…255; `messages`: the viewer's stream. `inertial`: null if
// the core got no readings. `spreads`: covariances of the landmarks in `ends`.
export interface Done {
  kind: 'done'; number: number; time: number; frame: Frame; light: number; messages: Uint8Array[]; bitmap: ImageBitmap | null; turn: number;
  inertial: Inertial | null; spreads: Readonly<Record<number, Spread>>;
}
export interface Answer { kind: 'answer'; what: Saved; bytes: Uint8Array<ArrayBuffer>; messages: Uint8Array[] }
export interface Failed { kind: 'failed'; error: string; what?: Saved }
export type FromWorker = Prepared | Ready | Done | Answer | Failed;

// Sent through the port. `pixels`: red green blue alpha.
export interface Look { number: number; width: number; height: number; pixels: ArrayBuffer }
// `found`: class, score, x, y, width, height of each detection; `free`: ready for the next image.
export type FromDetector = { kind: 'found'; number: number; found: Float32Array } | { kind: 'free' };
// Messages between the page and the detector's Worker.
export type ToDetector = { kind: 'open'; base: string; model: ArrayBuffer } | { kind: 'connect'; port: MessagePort };
export type DetectorNews = { kind: 'opened'; classes: string[] } | { kind: 'refused'; error: string } | { kind: 'looked'; milliseconds: number; things: number }
  | { kind: 'stopped'; error: string };
