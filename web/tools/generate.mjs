// Generates from stream.fbs: flatc's TypeScript accessors, and a table of all fields for the verifier, for which flatc
// has no TypeScript version. Output in scene/generated, which is not under version control.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
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

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const schema = parseSchema(readFileSync(fbs, 'utf8'));
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out, { recursive: true });
  try {
    execFileSync('flatc', ['--ts', '-o', out, fbs], { stdio: 'inherit' });
  } catch (error) {
    console.error(`web: flatc could not be run (${error.message}); Debian's package is flatbuffers-compiler`);
    process.exit(1);
  }
  writeFileSync(`${out}schema.ts`, '// Made from stream.fbs by tools/generate.mjs.\n' +
    `export const SCHEMA = ${JSON.stringify(schema, null, 1)} as const;\n`);
}
