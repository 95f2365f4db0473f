// The service worker: caches the page's files on first use, so that the page works offline. VERSION is a digest of all
// files (tools/build.mjs): a new version is cached completely beside the old one and used the next time the page is
// opened.
/// <reference lib="webworker" />
declare const VERSION: string;
declare const FILES: readonly string[];
const worker = self as unknown as ServiceWorkerGlobalScope;
const CACHE = `alidade-${VERSION}`;

worker.addEventListener('install', (event) => {
  event.waitUntil((async () => {
    const cache = await caches.open(CACHE);
    // Keep the page's query, which may contain the token required for the main page.
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

// The core's files (core/) are cached on first use, because only one of the two modules is needed.
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

// Current capabilities of the server; offline the last known ones, without processing on the computer.
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
