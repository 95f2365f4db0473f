// Serves the page as static files, with the headers for cross-origin isolation or without.
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { join, normalize } from 'node:path';

declare const WEB: string; // defined by tools/test.mjs

const TYPES: Record<string, string> = {
  html: 'text/html; charset=utf-8', js: 'text/javascript', mjs: 'text/javascript', css: 'text/css', svg: 'image/svg+xml', txt: 'text/plain; charset=utf-8',
  wasm: 'application/wasm', jpg: 'image/jpeg', webmanifest: 'application/manifest+json',
};
export const POLICY = "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; " +
  "style-src 'self'; img-src 'self' blob: data:; media-src 'self' blob:; connect-src 'self'; manifest-src 'self'";

// Built by scripts/wasm/build detector.
export const DETECTOR = join(process.env.ALIDADE_WASM ?? join(WEB, '../build-wasm'), 'detector/bin');

export interface Site { address: string; close(): Promise<void> }

// `more`: additional files, by name. `info`: replaces values of info.json.
export async function startSite(isolated: boolean, more: Readonly<Record<string, string>> = {}, info: object = {}): Promise<Site> {
  const http = createServer((request, response) => {
    const path = normalize(new URL(request.url ?? '/', 'http://localhost').pathname);
    const name = path === '/' ? 'index.html' : path.slice(1);
    const file = more[name] ?? (name.startsWith('core/detector/') ? join(DETECTOR, name.slice(14)) : name.startsWith('core/') ? join(WEB, 'core/dist', name.slice(5)) : join(WEB, 'phone/dist', name));
    if (isolated) {
      response.setHeader('Cross-Origin-Opener-Policy', 'same-origin');
      response.setHeader('Cross-Origin-Embedder-Policy', 'require-corp');
      response.setHeader('Content-Security-Policy', POLICY);
    }
    if (name === 'info.json') { // the same as the program's
      response.setHeader('Content-Type', 'application/json');
      return response.end(JSON.stringify({ mode: 'phone', connected: false, core: true, threads: existsSync(join(WEB, 'core/dist/threads/alidade.wasm')), ...info }));
    }
    if (!existsSync(file)) {
      response.statusCode = 404;
      return response.end();
    }
    response.setHeader('Content-Type', TYPES[name.split('.').pop()!] ?? 'application/octet-stream');
    return response.end(request.method === 'HEAD' ? '' : readFileSync(file));
  });
  await new Promise<void>((resolve) => { http.listen(0, '127.0.0.1', resolve); });
  return {
    address: `http://127.0.0.1:${(http.address() as AddressInfo).port}/`,
    close: () => new Promise((resolve) => {
      http.closeAllConnections();
      http.close(() => resolve());
    }),
  };
}
