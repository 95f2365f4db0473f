// The real program, started and ended by the tests. ALIDADE_BINARY names it.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { SKIP } from './browser.ts';

declare const WEB: string; // by tools/test.mjs

export const BINARY = process.env.ALIDADE_BINARY ? resolve(process.env.ALIDADE_BINARY) : join(WEB, '../build/bin/alidade');
export const NO_PROGRAM = SKIP || (existsSync(BINARY) ? false : `no ${BINARY} (scripts/build, or ALIDADE_BINARY)`);

export interface Program {
  address: string;
  port: number;
  ended: Promise<number | null>; // its status; null: by a signal
  kill(signal: NodeJS.Signals): void;
}

const folder = mkdtempSync(join(tmpdir(), 'alidade-page-'));
const running = new Set<Program>();

export const inFolder = (name: string) => join(folder, name);

// Until it ends; throws what it said when that was no success.
export async function run(...args: string[]): Promise<void> {
  const child = spawn(BINARY, args, { stdio: ['ignore', 'ignore', 'pipe'] });
  let said = '';
  child.stderr.on('data', (text) => { said += text; });
  const status = await new Promise((done) => child.on('close', done));
  if (status !== 0) throw new Error(`alidade ${args.join(' ')}: ${status}\n${said}`);
}

// One that serves the page; the address is the first that it prints.
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

// Lines of numbers, those of comments and heads left out.
export function table(path: string): number[][] {
  return readFileSync(path, 'utf8').split('\n').filter((line) => /^[-+\d.]/.test(line)).map((line) => line.trim().split(/\s+/).map(Number));
}
