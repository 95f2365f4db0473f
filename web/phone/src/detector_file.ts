// Stores the user's detector network in the browser's cache, for offline use.

const CACHE = 'detector'; // separate from the service worker's caches, which are replaced with each version of the page
const KEY = 'detector.onnx';
export const MOST_BYTES = 200e6; // bytes; limit of the page's memory besides the core

let here: ArrayBuffer | null = null; // used when the page is not secure and the browser stores nothing

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
