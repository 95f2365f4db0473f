// Starts and stops the real program as a server.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { BINARY, NO_BINARY } from '../../scene/test/binary.ts';
import { SKIP } from './browser.ts';

export { BINARY, run, table } from '../../scene/test/binary.ts';
export const NO_PROGRAM = SKIP || NO_BINARY;

export interface Program {
  address: string;
  port: number;
  ended: Promise<number | null>; // exit status; null: ended by a signal
  kill(signal: NodeJS.Signals): void;
}

const folder = mkdtempSync(join(tmpdir(), 'alidade-page-'));
const running = new Set<Program>();

export const inFolder = (name: string) => join(folder, name);

// Starts a program that serves the page; the address is the first one it prints.
export async function start(...args: string[]): Promise<Program> {
  const child = spawn(BINARY, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  const ended = new Promise<number | null>((done) => child.on('close', done));
  const address = new Promise<string>((done, failed) => {
    child.stdout.on('data', (text) => {
      said += text;
      const match = /https?:\/\/[^\s]+(?=[^\n]*\n)/.exec(said);
      if (match) done(match[0]);
    });
    child.stderr.on('data', (text) => { said += text; });
    void ended.then((status) => failed(new Error(`alidade ${args.join(' ')}: ${status}\n${said}`)));
  });
  const url = new URL(await address);
  const program: Program = { address: url.href, port: Number(url.port), ended, kill: (signal) => void child.kill(signal) };
  running.add(program);
  void ended.then(() => running.delete(program));
  return program;
}

export async function endAll(): Promise<void> {
  const ends = [...running].map((program) => program.ended);
  for (const program of running) program.kill('SIGKILL');
  await Promise.all(ends);
  rmSync(folder, { recursive: true, force: true });
}
