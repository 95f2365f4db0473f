// Bundles the viewer into viewer/dist and the phone page into phone/dist, with a compressed version of every file.
import { build } from 'esbuild';
import { createHash } from 'node:crypto';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const web = fileURLToPath(new URL('..', import.meta.url));
const source = join(web, 'viewer/src');
const dist = join(web, 'viewer/dist');

// Packages included in the bundle, from esbuild's metafile, so that the list is complete.
export function bundled(metafile) {
  const names = new Set();
  for (const input of Object.keys(metafile.inputs)) {
    const match = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (match) names.add(match[1]);
  }
  return [...names].sort().map((name) => {
    const folder = join(web, 'node_modules', name);
    const { version, license } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
    const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
    return { name, version, licence: String(license).replace(/^SEE LICENSE IN .*$/i, 'Apache-2.0'), text: file ? readFileSync(join(folder, file), 'utf8') : '' };
  });
}

const options = {
  bundle: true, minify: true, format: 'esm', target: ['es2022', 'chrome109', 'firefox115', 'safari16.4'], legalComments: 'none',
  nodePaths: [join(web, 'node_modules')], alias: { '@alidade/scene': join(web, 'scene/src/index.ts') }, logLevel: 'warning',
};

const LATER = ['mp4', 'scene3d']; // scripts that the phone page loads only when they are needed

// The phone page: its script, the Workers, and the service worker, which contains the list of files and their digest.
export async function buildPhone() {
  const from = join(web, 'phone/src');
  const to = join(web, 'phone/dist');
  rmSync(to, { recursive: true, force: true });
  mkdirSync(to, { recursive: true });
  const { version } = JSON.parse(readFileSync(join(web, 'core/package.json'), 'utf8'));
  const main = { ...options, entryPoints: [join(from, 'main.ts')], outfile: join(to, 'phone.js') };
  const define = { BUNDLED: '[]', PROGRAM: JSON.stringify(`Alidade ${version}`) };
  const inputs = {};
  for (const more of [{ ...main, define }, ...LATER.map((name) => ({ ...options, entryPoints: [join(from, `${name}.ts`)], outfile: join(to, `${name}.js`) }))]) {
    Object.assign(inputs, (await build({ ...more, write: false, metafile: true })).metafile.inputs);
  }
  const packages = bundled({ inputs });
  await build({ ...main, define: { ...define, BUNDLED: JSON.stringify(packages.map(({ name, version: number, licence }) => ({ name, version: number, licence }))) } });
  for (const name of ['worker', 'detector_worker', ...LATER]) await build({ ...options, entryPoints: [join(from, `${name}.ts`)], outfile: join(to, `${name}.js`) });
  await build({ ...options, entryPoints: [join(from, 'phone.css')], outfile: join(to, 'phone.css') });
  for (const name of ['index.html', 'icon.svg', 'manifest.webmanifest']) copyFileSync(join(from, name), join(to, name));
  writeFileSync(join(to, 'licences.txt'), licences(packages));
  const files = readdirSync(to).sort();
  const digest = createHash('sha256');
  for (const name of files) digest.update(readFileSync(join(to, name)));
  const core = join(web, 'core/dist');
  for (const variant of ['single', 'threads']) if (existsSync(join(core, variant))) digest.update(readFileSync(join(core, variant, 'alidade.wasm')));
  await build({
    ...options, entryPoints: [join(from, 'sw.ts')], outfile: join(to, 'sw.js'), format: 'iife',
    define: { VERSION: JSON.stringify(digest.digest('hex').slice(0, 16)), FILES: JSON.stringify(files) },
  });
  return compressed(to);
}

export async function buildViewer() {
  rmSync(dist, { recursive: true, force: true });
  mkdirSync(dist, { recursive: true });
  const entry = join(source, 'main.ts');
  const { metafile } = await build({ ...options, entryPoints: [entry], write: false, outfile: join(dist, 'viewer.js'), metafile: true, define: { BUNDLED: '[]' } });
  const packages = bundled(metafile);
  const named = packages.map(({ name, version, licence }) => ({ name, version, licence }));
  await build({ ...options, entryPoints: [entry], outfile: join(dist, 'viewer.js'), define: { BUNDLED: JSON.stringify(named) } });
  await build({ ...options, entryPoints: [join(source, 'viewer.css')], outfile: join(dist, 'viewer.css') });
  copyFileSync(join(source, 'index.html'), join(dist, 'index.html'));
  copyFileSync(join(source, 'favicon.svg'), join(dist, 'favicon.svg'));
  writeFileSync(join(dist, 'licences.txt'), licences(packages));
  return compressed(dist);
}

function licences(packages) {
  const rule = '-'.repeat(80);
  return packages.map(({ name, version, licence, text }) =>
    `${rule}\n${name} ${version}: ${licence}\n${rule}\n${text || 'See https://www.apache.org/licenses/LICENSE-2.0\n'}`).join('\n');
}

// Compressed versions for slow networks; about a quarter of the size.
function compressed(folder) {
  return readdirSync(folder).map((name) => {
    const small = gzipSync(readFileSync(join(folder, name)), { level: 9 });
    writeFileSync(join(folder, `${name}.gz`), small);
    return { name, bytes: statSync(join(folder, name)).size, gzip: small.length };
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  if (!existsSync(join(web, 'node_modules'))) throw new Error('web: run npm ci first');
  for (const { name, bytes, gzip } of [...await buildViewer(), ...await buildPhone()]) console.log(`${name.padEnd(14)} ${String(bytes).padStart(8)} bytes, ${gzip} gzipped`);
}
