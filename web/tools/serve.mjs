// Serves viewer/dist with a sample stream, to try the page without the program.
// node tools/serve.mjs [--port N] [--replay | --file run.stream] [--frames N] [--speed X] [--points N]
import { build } from 'esbuild';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { fileURLToPath } from 'node:url';

const web = fileURLToPath(new URL('..', import.meta.url));
const outfile = join(web, '.test/serve.mjs');
await build({
  entryPoints: [join(web, 'viewer/test/server.ts')], outfile, bundle: true, platform: 'node', format: 'esm', target: 'node18', packages: 'external',
  alias: { '@alidade/scene': join(web, 'scene/src/index.ts') }, define: { WEB: JSON.stringify(web) },
});
const { startServer } = await import(pathToFileURL(outfile).href);
const option = (name, otherwise) => {
  const at = process.argv.indexOf('--' + name);
  return at < 0 ? otherwise : process.argv[at + 1];
};
const server = await startServer({
  port: Number(option('port', 8017)), mode: process.argv.includes('--replay') || process.argv.includes('--file') ? 'replay' : 'live',
  file: option('file', undefined), speed: Number(option('speed', 1)),
  sample: { frames: Number(option('frames', 900)), depthPoints: Number(option('points', 1500)) },
});
console.log(server.address);
