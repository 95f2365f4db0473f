// Imitates the program's server with a sample stream: the pages with their policy, info.json, the stream or the file.
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import type { AddressInfo, Socket } from 'node:net';
import { join } from 'node:path';
import { WebSocketServer } from 'ws';
import type { WebSocket } from 'ws';
import type { Message } from '@alidade/scene';
import { encode } from '../../scene/test/encode.ts';
import { Sample } from '../../scene/test/sample.ts';
import type { SampleSettings } from '../../scene/test/sample.ts';

declare const WEB: string; // defined by tools/test.mjs

export const POLICY = "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; script-src 'self'; style-src 'self'; " +
  "img-src 'self'; connect-src 'self'; require-trusted-types-for 'script'; trusted-types 'none'";

const TYPES: Record<string, string> = {
  html: 'text/html; charset=utf-8', js: 'text/javascript', css: 'text/css', svg: 'image/svg+xml', txt: 'text/plain; charset=utf-8',
};

export interface ServerSettings {
  port?: number;
  mode?: 'live' | 'replay';
  file?: string;
  speed?: number; // times real time; 0: frames are sent on request only
  sample?: SampleSettings;
  start?: number; // number of frames sent before the first client
}

export interface Server {
  address: string;
  port: number;
  sample: Sample;
  asked: string[];
  send(bytes: Uint8Array): void;
  advance(frames: number): void;
  frame(): number;
  clients(): number;
  close(): Promise<void>;
}

export function recorded(settings: SampleSettings = {}): Buffer {
  const parts: Uint8Array[] = [Buffer.from('ALIDSTR1')];
  for (const message of new Sample(settings).messages()) {
    const bytes = encode(message);
    const head = Buffer.alloc(8);
    head.writeUInt32LE(bytes.length, 0);
    parts.push(head, bytes, Buffer.alloc((8 - (bytes.length % 8)) % 8));
  }
  return Buffer.concat(parts);
}

export async function startServer(settings: ServerSettings = {}): Promise<Server> {
  const { mode = 'live', speed = 1 } = settings;
  const sample = new Sample(settings.sample);
  const file = mode === 'replay' ? settings.file ? readFileSync(settings.file) : recorded(settings.sample) : null;
  const http = createServer((request, response) => {
    const path = new URL(request.url ?? '/', 'http://localhost').pathname;
    const name = path === '/' ? 'index.html' : path.slice(1);
    response.setHeader('Content-Security-Policy', POLICY);
    response.setHeader('X-Content-Type-Options', 'nosniff');
    if (name === 'info.json') {
      response.setHeader('Content-Type', 'application/json');
      return response.end(JSON.stringify({ mode, title: 'sample room', program: 'alidade 0.2.0' }));
    }
    if (name === 'run.stream' && file) return response.end(file);
    if (!/^(index\.html|viewer\.js|viewer\.css|favicon\.svg|licences\.txt)$/.test(name)) {
      response.statusCode = 404;
      return response.end();
    }
    response.setHeader('Content-Type', TYPES[name.split('.').pop()!]);
    return response.end(readFileSync(join(WEB, 'viewer/dist', name)));
  });
  const asked: string[] = [];
  const sockets = new WebSocketServer({ noServer: true });
  const clients = new Set<WebSocket>();
  const connections = new Set<Socket>();
  let frame = 0;
  let paused = false;
  const playback = (): Message => ({ kind: 'playback', paused, finished: frame >= sample.frames, mayPause: true });
  const send = (bytes: Uint8Array) => clients.forEach((client) => client.send(bytes));
  const advance = (frames: number) => {
    for (; frames > 0 && frame < sample.frames; --frames) {
      for (const message of sample.step(frame)) send(encode(message));
      if (++frame === sample.frames) send(encode(playback()));
    }
  };
  http.on('connection', (socket: Socket) => {
    connections.add(socket);
    socket.on('close', () => connections.delete(socket));
  });
  http.on('upgrade', (request, socket, head) => {
    if (!request.url?.startsWith('/stream') || mode !== 'live') return void socket.destroy();
    sockets.handleUpgrade(request, socket, head, (client) => {
      clients.add(client);
      client.on('close', () => clients.delete(client));
      client.on('message', (text) => {
        const { do: what } = JSON.parse(String(text)) as { do: string };
        asked.push(what);
        if (what === 'pause' || what === 'resume') {
          paused = what === 'pause';
          send(encode(playback()));
        }
        if (what === 'step' && paused) advance(1);
        if (what === 'whole') for (const message of [sample.whole(), ...sample.events]) client.send(encode(message));
      });
      for (const message of [sample.hello(), sample.whole(), ...sample.events, playback()]) client.send(encode(message));
    });
  });
  advance(settings.start ?? 0);
  let due = 0;
  const timer = setInterval(() => {
    if (mode !== 'live' || paused || speed === 0) return;
    due += (speed * 30) / 30;
    advance(Math.floor(due));
    due -= Math.floor(due);
  }, 1000 / 30);
  await new Promise<void>((resolve) => { http.listen(settings.port ?? 0, '127.0.0.1', resolve); });
  const { port } = http.address() as AddressInfo;
  return {
    address: `http://127.0.0.1:${port}/`, port, sample, asked, send, advance, frame: () => frame, clients: () => clients.size,
    close() {
      clearInterval(timer);
      connections.forEach((socket) => socket.destroy());
      return new Promise((resolve) => { http.close(() => resolve()); });
    },
  };
}
