// Runs the real program, set by ALIDADE_BINARY, to its end.
import { spawn } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';

declare const WEB: string; // defined by tools/test.mjs

export const BINARY = process.env.ALIDADE_BINARY ? resolve(process.env.ALIDADE_BINARY) : join(WEB, '../build/bin/alidade');
export const NO_BINARY = existsSync(BINARY) ? false : `no ${BINARY} (scripts/build, or ALIDADE_BINARY)`;

// Waits for the end; throws the program's messages on failure.
export async function run(...args: string[]): Promise<void> {
  const child = spawn(BINARY, args, { stdio: ['ignore', 'ignore', 'pipe'] });
  let said = '';
  child.stderr.on('data', (text) => { said += text; });
  const status = await new Promise((done) => child.on('close', done));
  if (status !== 0) throw new Error(`alidade ${args.join(' ')}: ${status}\n${said}`);
}

// Rows of numbers; comments and headers are skipped.
export function table(path: string): number[][] {
  return readFileSync(path, 'utf8').split('\n').filter((line) => /^[-+\d.]/.test(line)).map((line) => line.trim().split(/\s+/).map(Number));
}
