// Bundles each *.test.ts of a folder and runs them with Node's test runner. Arguments: the folder, then words that the
// file names must contain, and options of Node's runner (--test-name-pattern=…).
import { build } from 'esbuild';
import { spawnSync } from 'node:child_process';
import { readdirSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const web = fileURLToPath(new URL('..', import.meta.url));
const [folder, ...rest] = process.argv.slice(2);
const words = rest.filter((word) => !word.startsWith('--'));
const options = rest.filter((word) => word.startsWith('--'));
const names = readdirSync(join(web, folder))
  .filter((name) => name.endsWith('.test.ts') && words.every((word) => name.includes(word)));
if (names.length === 0) {
  console.error(`${folder}: no test file's name holds ${words.join(', ')}`);
  process.exit(2);
}
const outdir = join(web, '.test', folder);
rmSync(outdir, { recursive: true, force: true });
await build({
  entryPoints: names.map((name) => join(web, folder, name)),
  outdir, bundle: true, platform: 'node', format: 'esm', target: 'node18', outExtension: { '.js': '.mjs' },
  packages: 'external', external: ['../tools/*'], alias: { '@alidade/scene': join(web, 'scene/src/index.ts') },
  define: { WEB: JSON.stringify(web) }, sourcemap: 'inline', logLevel: 'warning',
});
const files = names.map((name) => join(outdir, name.replace(/\.ts$/, '.mjs')));
// Two files in parallel, because pages mostly wait. Node before 20.10 has no such option.
const [major, minor] = process.versions.node.split('.').map(Number);
const together = major > 20 || (major === 20 && minor >= 10) ? ['--test-concurrency=2'] : [];
const run = spawnSync(process.execPath, ['--enable-source-maps', '--test', ...together, ...options, ...files], { stdio: 'inherit' });
process.exit(run.status ?? 1);
