// Bundles the viewer into viewer/dist: five files, all that the program serves, each also compressed.
import { build } from 'esbuild';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const web = fileURLToPath(new URL('..', import.meta.url));
const source = join(web, 'viewer/src');
const dist = join(web, 'viewer/dist');

// Packages whose code is in the bundle; read off what esbuild took in, so that none is forgotten.
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
  const rule = '-'.repeat(80);
  writeFileSync(join(dist, 'licences.txt'), packages.map(({ name, version, licence, text }) =>
    `${rule}\n${name} ${version}: ${licence}\n${rule}\n${text || 'See https://www.apache.org/licenses/LICENSE-2.0\n'}`).join('\n'));
  // The program serves these to whoever takes them: over Wi-Fi a quarter of the bytes.
  return readdirSync(dist).map((name) => {
    const small = gzipSync(readFileSync(join(dist, name)), { level: 9 });
    writeFileSync(join(dist, `${name}.gz`), small);
    return { name, bytes: statSync(join(dist, name)).size, gzip: small.length };
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  if (!existsSync(join(web, 'node_modules'))) throw new Error('web: run npm ci first');
  for (const { name, bytes, gzip } of await buildViewer()) console.log(`${name.padEnd(14)} ${String(bytes).padStart(8)} bytes, ${gzip} gzipped`);
}
