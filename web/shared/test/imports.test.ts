// Which part of web/ may take something from which other: the floors of the pages.
import assert from 'node:assert/strict';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';
import { test } from 'node:test';

declare const WEB: string; // defined by tools/test.mjs

// Each part may use itself and those listed. Tests and benchmarks of all parts may use scene and shared, where the helpers of tests are.
const MAY_USE: Record<string, readonly string[]> = {
  scene: [],
  core: [],
  shared: ['scene'],
  viewer: ['scene', 'shared'],
  phone: ['scene', 'shared', 'core'],
  mcap: ['scene'],
};

const partOf = (file: string) => relative(WEB, file).split('/')[0]!;

function files(folder: string): string[] {
  if (!existsSync(folder)) return [];
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    return entry.isDirectory() ? files(path) : /\.(ts|mjs|css|html)$/.test(entry.name) ? [path] : [];
  });
}

// Files of web/ that `text`, the content of `file`, refers to.
export function references(file: string, text: string): string[] {
  const found = [...text.matchAll(/(?:\bfrom|\bimport|\bimport\(|@import|\bsrc=|\bhref=)\s*['"]([^'"]+)['"]/g)].map(([, name]) => name!);
  return found.flatMap((name) => (name === '@alidade/scene' ? [join(WEB, 'scene/src/index.ts')] : name.startsWith('.') ? [resolve(dirname(file), name)] : []));
}

function violations(file: string, text: string): string[] {
  const part = partOf(file);
  const test = relative(WEB, file).split('/')[1] !== 'src'; // or a benchmark
  return references(file, text).flatMap((used) => {
    const other = partOf(used);
    const name = `${relative(WEB, file)} uses ${relative(WEB, used)}`;
    const allowed = [part, ...MAY_USE[part]!, ...(test ? ['scene', 'shared'] : [])];
    if (!allowed.includes(other)) return [name];
    return !test && relative(WEB, used).split('/')[1] === 'test' ? [`${name}, which is a test`] : [];
  });
}

test('each part of web/ uses only the parts below it', () => {
  const parts = Object.keys(MAY_USE);
  const all = parts.flatMap((part) => ['src', 'test', 'bench'].flatMap((folder) => files(join(WEB, part, folder)))).filter((file) => !file.endsWith('imports.test.ts'));
  for (const part of parts) assert.ok(all.some((file) => partOf(file) === part), `no files of ${part}`);
  assert.deepEqual(all.flatMap((file) => violations(file, readFileSync(file, 'utf8'))), []);
  const unlisted = readdirSync(WEB, { withFileTypes: true }).filter((entry) => entry.isDirectory() && existsSync(join(WEB, entry.name, 'src'))).map(({ name }) => name);
  assert.deepEqual(unlisted.filter((name) => !parts.includes(name)), []);
});

test('a page that takes something from the other page is found', () => {
  const file = join(WEB, 'phone/src/main.ts');
  for (const line of ["import { byId } from '../../viewer/src/dom.ts';", "@import '../../viewer/src/palette.css';", "const part = await import('../../viewer/src/dom.ts');",
    "export { byId } from '../../viewer/src/dom.ts';", "import '../test/server.ts';"]) {
    assert.equal(violations(file, line).length, 1, line);
  }
  for (const line of ["import { State } from '@alidade/scene';", "import { byId } from '../../shared/src/dom.ts';", "import { Slam } from '../../core/src/index.ts';"]) {
    assert.deepEqual(violations(file, line), [], line);
  }
});
