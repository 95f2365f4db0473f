// The service worker: the page's files are kept when it is first opened, and come from there, so that it works offline. VERSION is a digest of all
// of them (tools/build.mjs): a new version is taken in whole, beside the old one, and used from the next opening on.
/// <reference lib="webworker" />
declare const VERSION: string;
declare const FILES: readonly string[];
const worker = self as unknown as ServiceWorkerGlobalScope;
const CACHE = `alidade-${VERSION}`;

worker.addEventListener('install', (event) => {
  event.waitUntil((async () => {
    const cache = await caches.open(CACHE);
    // With the page's own query, which may hold the token that the first one of them asks for.
    await Promise.all(FILES.map(async (name) => {
      const answer = await fetch(new Request(name + worker.location.search, { cache: 'reload' }));
      if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
      await cache.put(new URL(name, worker.registration.scope).href, answer);
    }));
    await worker.skipWaiting();
  })());
});

worker.addEventListener('activate', (event) => {
  event.waitUntil((async () => {
    for (const name of await caches.keys()) if (name.startsWith('alidade-') && name !== CACHE) await caches.delete(name);
    await worker.clients.claim();
  })());
});

// The core's files (core/) are kept when they are first asked for: only one of its two modules is.
worker.addEventListener('fetch', (event) => {
  const { request } = event;
  const address = new URL(request.url);
  const scope = new URL(worker.registration.scope);
  if (request.method !== 'GET') return;
  if (address.origin !== scope.origin || !address.pathname.startsWith(scope.pathname)) return;
  const name = address.pathname.slice(scope.pathname.length) || 'index.html';
  if (name === 'info.json') return event.respondWith(freshInfo(request, new URL(name, scope).href));
  if (!FILES.includes(name) && !name.startsWith('core/')) return;
  event.respondWith((async () => {
    const cache = await caches.open(CACHE);
    const kept = await cache.match(new URL(name, scope).href);
    if (kept) return kept;
    const answer = await fetch(request);
    if (answer.ok) await cache.put(new URL(name, scope).href, answer.clone());
    return answer;
  })());
});

// What the server offers now; offline what it offered last, but for the work that it did.
async function freshInfo(request: Request, name: string): Promise<Response> {
  const cache = await caches.open(CACHE);
  try {
    const answer = await fetch(request);
    if (answer.ok) await cache.put(name, answer.clone());
    return answer;
  } catch (error) {
    const kept = await cache.match(name);
    if (!kept) throw error;
    return Response.json({ ...await kept.json() as object, connected: false });
  }
}
