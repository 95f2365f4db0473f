// Generates TypeScript from sources in C++, so that names and words exist once. Not under version control.
// - scene/generated, from stream.fbs: flatc's accessors, and a table of all fields for the verifier, for which flatc has
//   no TypeScript version.
// - failures.ts, in scene/generated and core/src/generated: why a frame has no pose, from src/alidade/tracking.
// - core/src/generated/frame_numbers.ts, from wasm/frame_numbers.h.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const fbs = fileURLToPath(new URL('../../src/alidade/stream/stream.fbs', import.meta.url));
const out = fileURLToPath(new URL('../scene/generated/', import.meta.url));

const SCALARS = {
  bool: 1, byte: 1, ubyte: 1, short: 2, ushort: 2, int: 4, uint: 4, float: 4, long: 8, ulong: 8, double: 8,
};

// Parses the subset of the language that stream.fbs uses: structs, tables, enums and unions without attributes.
export function parseSchema(text) {
  const plain = text.replace(/\/\/.*$/gm, '');
  const sizes = new Map(Object.entries(SCALARS).map(([name, size]) => [name, { size, align: size }]));
  const tables = {};
  const unions = new Map();
  const body = /\b(struct|table|enum|union)\s+(\w+)\s*(?::\s*(\w+)\s*)?\{([^}]*)\}/g;
  for (const [, kind, name, base, content] of plain.matchAll(body)) {
    if (kind === 'enum') sizes.set(name, sizes.get(base));
    if (kind === 'union') unions.set(name, content.split(',').map((entry) => entry.trim()).filter(Boolean));
    if (kind === 'struct') {
      let size = 0;
      let align = 1;
      for (const [, type] of content.matchAll(/\w+\s*:\s*(\w+)/g)) {
        const of = sizes.get(type);
        size = Math.ceil(size / of.align) * of.align + of.size;
        align = Math.max(align, of.align);
      }
      sizes.set(name, { size: Math.ceil(size / align) * align, align });
    }
    if (kind === 'table') {
      tables[name] = [...content.matchAll(/(\w+)\s*:\s*(\[?)(\w+)/g)].map(([, field, list, type]) => ({ field, list, type }));
    }
  }
  const schema = {};
  for (const [name, fields] of Object.entries(tables)) {
    schema[name] = [];
    for (const { field, list, type } of fields) {
      if (unions.has(type)) {
        schema[name].push({ name: `${field}_type`, kind: 'scalar', size: 1, align: 1 });
        schema[name].push({ name: field, kind: 'union', tables: unions.get(type) });
      } else if (type === 'string' && !list) {
        schema[name].push({ name: field, kind: 'string' });
      } else if (type in tables) {
        schema[name].push({ name: field, kind: list ? 'tables' : 'table', table: type });
      } else if (sizes.has(type)) {
        schema[name].push({ name: field, kind: list ? 'vector' : 'scalar', ...sizes.get(type) });
      } else {
        throw new Error(`stream.fbs: ${name}.${field} has a type this page does not know: ${list}${type}`);
      }
    }
  }
  const [, root] = /root_type\s+(\w+)/.exec(plain);
  const [, identifier] = /file_identifier\s+"(.{4})"/.exec(plain);
  return { root, identifier, tables: schema };
}

const strings = (text) => [...text.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map(([quoted]) => JSON.parse(quoted)).join('');

// 'kFewCorners' → 'few_corners'
const nameOf = (enumerator) => enumerator.slice(1).replace(/(?!^)([A-Z])/g, '_$1').toLowerCase();

// Words by enumerator, of a function in C++ that consists of one switch.
function words(text, call) {
  const from = text.indexOf(`const char* ${call}(TrackFailure failure) {`);
  const body = text.slice(from, text.indexOf('\n}', from));
  const of = {};
  for (const [, cases, returned] of body.matchAll(/((?:case TrackFailure::\w+:\s*)+)return ([^;]+);/g)) {
    for (const [, name] of cases.matchAll(/TrackFailure::(\w+)/g)) of[nameOf(name)] = strings(returned);
  }
  return of;
}

// Names in the enum's order, and words, from the texts of track_failure.h and track_failure.cc.
export function parseFailures(header, source) {
  const [, body] = /enum class TrackFailure[^{]*\{([^}]*)\}/.exec(header);
  const names = [...body.replace(/\/\/.*$/gm, '').matchAll(/\b(k\w+)/g)].map(([, name]) => nameOf(name));
  return { names, reasons: words(source, 'ReasonText') };
}

// Field names of a struct of doubles, in order: 'fov_sigma' → 'fovSigma'.
export function parseNumbers(header, struct = 'FrameNumbers') {
  const [, body] = new RegExp(`struct ${struct} \\{([^}]*)\\}`).exec(header);
  return [...body.replace(/\/\/.*$/gm, '').matchAll(/\bdouble (\w+)/g)].map(([, name]) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase()));
}

const source = (path) => readFileSync(fileURLToPath(new URL(`../../${path}`, import.meta.url)), 'utf8');

function failuresText() {
  const { names, reasons } = parseFailures(source('src/alidade/tracking/track_failure.h'), source('src/alidade/tracking/track_failure.cc'));
  const [none, ...failures] = names;
  if (none !== 'none' || failures.some((name) => !reasons[name])) throw new Error('web: track_failure.h and .cc could not be read');
  return '// Made from src/alidade/tracking/track_failure.h and .cc by tools/generate.mjs.\n' +
    `export const FAILURES = ${JSON.stringify(failures, null, 1)} as const; // of TrackFailure 1, 2, …\n` +
    '/** Why a frame has no pose. */\nexport type Failure = (typeof FAILURES)[number];\n' +
    `/** The same in words. */\nexport const REASONS: Readonly<Record<Failure, string>> = ${JSON.stringify(reasons, null, 1)};\n`;
}

// Makes `folder` hold what is in `made`, and removes `made`. Each file is replaced at once, and only where it differs:
// another build may be reading it.
function replace(folder, made) {
  mkdirSync(folder, { recursive: true });
  const names = readdirSync(made);
  for (const name of readdirSync(folder)) {
    if (!names.includes(name)) rmSync(`${folder}/${name}`, { recursive: true, force: true });
  }
  for (const name of names) {
    const [from, to] = [`${made}/${name}`, `${folder}/${name}`];
    if (statSync(from).isDirectory()) replace(to, from);
    else if (!existsSync(to) || !readFileSync(from).equals(readFileSync(to))) renameSync(from, to);
  }
  rmSync(made, { recursive: true, force: true });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const schema = parseSchema(readFileSync(fbs, 'utf8'));
  const made = fileURLToPath(new URL(`../generated-${process.pid}/`, import.meta.url));
  const [scene, core] = [`${made}scene/`, `${made}core/`];
  for (const folder of [scene, core]) mkdirSync(folder, { recursive: true });
  try {
    execFileSync('flatc', ['--ts', '-o', scene, fbs], { stdio: 'inherit' });
  } catch (error) {
    rmSync(made, { recursive: true, force: true });
    console.error(`web: flatc could not be run (${error.message}); Debian's package is flatbuffers-compiler`);
    process.exit(1);
  }
  writeFileSync(`${scene}schema.ts`, '// Made from stream.fbs by tools/generate.mjs.\n' +
    `export const SCHEMA = ${JSON.stringify(schema, null, 1)} as const;\n`);
  const failures = failuresText();
  for (const folder of [scene, core]) writeFileSync(`${folder}failures.ts`, failures);
  writeFileSync(`${core}frame_numbers.ts`, '// Made from wasm/frame_numbers.h by tools/generate.mjs.\n' +
    `export const FRAME_NUMBERS = ${JSON.stringify(parseNumbers(source('wasm/frame_numbers.h')), null, 1)} as const;\n` +
    `export const INERTIAL_NUMBERS = ${JSON.stringify(parseNumbers(source('wasm/frame_numbers.h'), 'InertialNumbers'), null, 1)} as const;\n`);
  replace(out, scene);
  replace(fileURLToPath(new URL('../core/src/generated/', import.meta.url)), core);
  rmSync(made, { recursive: true, force: true });
}
