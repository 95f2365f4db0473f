// Assembles the npm package: core/dist with index.js, its types and the modules built by scripts/wasm/build.
import { build } from 'esbuild';
import { spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const web = fileURLToPath(new URL('..', import.meta.url));
const dist = join(web, 'core/dist');
const built = process.env.ALIDADE_WASM ?? join(web, '../build-wasm');

rmSync(dist, { recursive: true, force: true });
mkdirSync(dist, { recursive: true });
await build({ entryPoints: [join(web, 'core/src/index.ts')], outfile: join(dist, 'index.js'), format: 'esm', target: 'es2022', bundle: true, logLevel: 'warning' });
const types = spawnSync(process.execPath, [join(web, 'node_modules/typescript/bin/tsc'), '--declaration', '--emitDeclarationOnly', '--outDir', dist,
  '--target', 'ES2022', '--lib', 'ES2022,DOM', '--module', 'ESNext', '--moduleResolution', 'bundler', '--strict', join(web, 'core/src/index.ts')], { stdio: 'inherit' });
if (types.status !== 0) process.exit(1);
// The program that `alidade-bench phone` runs, beside the modules.
await build({ entryPoints: [join(web, 'core/bench/bench.ts')], outfile: join(built, 'bench/bench.mjs'), format: 'esm', target: 'node18', platform: 'node', bundle: true, logLevel: 'warning' });
for (const variant of ['single', 'threads']) {
  const from = join(built, variant, 'bin');
  if (!existsSync(join(from, 'alidade.wasm'))) {
    console.log(`${variant}: not built (scripts/wasm/build ${variant})`);
    continue;
  }
  mkdirSync(join(dist, variant));
  for (const name of ['alidade.mjs', 'alidade.wasm', 'alidade.worker.js']) {
    if (existsSync(join(from, name))) copyFileSync(join(from, name), join(dist, variant, name));
  }
}
