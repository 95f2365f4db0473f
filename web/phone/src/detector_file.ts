// The user's detector, kept on the device: its file in the browser's cache, so that it is there without a network.

const CACHE = 'detector'; // not one of the service worker's, which go with each version of the page
const KEY = 'detector.onnx';
export const MOST_BYTES = 200e6; // what a page's memory holds besides the core

let here: ArrayBuffer | null = null; // where the browser keeps nothing (no secure page)

export async function keepFile(model: ArrayBuffer): Promise<void> {
  here = model;
  if ('caches' in self) await (await caches.open(CACHE)).put(KEY, new Response(model));
}

export async function keptFile(): Promise<ArrayBuffer | null> {
  const kept = 'caches' in self ? await (await caches.open(CACHE)).match(KEY) : undefined;
  return await kept?.arrayBuffer() ?? here;
}

export async function forgetFile(): Promise<void> {
  here = null;
  if ('caches' in self) await caches.delete(CACHE);
}
