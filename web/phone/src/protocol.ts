// What the page and its Worker say to each other.
import type { Frame } from '../../core/src/index.ts';

export interface Start {
  kind: 'start';
  base: string;                // folder of alidade.mjs
  threads: number;             // 1: the module without
  width: number; height: number;  // of the pictures as they are worked on
  fov: number | null;          // horizontal, degrees; null: found on the way
  settings: Record<string, string | number | boolean>;
  classes: readonly string[];  // of the detector; none: there is none
}
// `port`: to the detector's Worker. It is given the newest picture when it is free; what it finds comes when it comes.
export interface Detector { kind: 'detector'; port: MessagePort }
// `turn`: quarters that the screen was turned clockwise since the start; the picture is turned back before it is worked on.
export interface Picture { kind: 'picture'; number: number; time: number; bitmap: ImageBitmap; turn: number }
export const SAVED = ['map', 'trajectory', 'cloud', 'finish'] as const;
export type Saved = (typeof SAVED)[number];
export interface Ask { kind: 'ask'; what: Saved }
export type ToWorker = Start | Detector | Picture | Ask;

export interface Ready { kind: 'ready' }
// `bitmap`: the picture, back again; `light`: its mean grey, 0…255; `messages`: the viewer's stream.
export interface Done { kind: 'done'; number: number; time: number; frame: Frame; light: number; messages: Uint8Array[]; bitmap: ImageBitmap | null; turn: number }
export interface Answer { kind: 'answer'; what: Saved; bytes: Uint8Array<ArrayBuffer>; messages: Uint8Array[] }
export interface Failed { kind: 'failed'; error: string; what?: Saved }
export type FromWorker = Ready | Done | Answer | Failed;

// Through the port. `pixels`: red green blue alpha.
export interface Look { number: number; width: number; height: number; pixels: ArrayBuffer }
// `found`: class, score, x, y, width, height of each thing; `free`: the next picture may come.
export type FromDetector = { kind: 'found'; number: number; found: Float32Array } | { kind: 'free' };
// What the page and the detector's Worker say to each other.
export type ToDetector = { kind: 'open'; base: string; model: ArrayBuffer } | { kind: 'connect'; port: MessagePort };
export type DetectorNews = { kind: 'opened'; classes: string[] } | { kind: 'refused'; error: string } | { kind: 'looked'; milliseconds: number; things: number }
  | { kind: 'stopped'; error: string };
