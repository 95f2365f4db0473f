// Ruff on the Python files given as arguments, as WebAssembly: neither Debian 12 nor npm has it as a program.
// Prints `file:line:column: rule message`; status 1 when there is one.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const { Workspace, PositionEncoding } = createRequire(import.meta.url)('@astral-sh/ruff-wasm-nodejs');
// Rules that find mistakes: Pyflakes, some of pycodestyle's and Pylint's, flake8-bugbear, names that NumPy has removed.
const settings = { 'line-length': 120, 'target-version': 'py39', lint: { select: ['E4', 'E7', 'E9', 'F', 'B', 'PLE', 'NPY'], ignore: ['B007'] } };
const workspace = new Workspace(settings, PositionEncoding.Utf32);
let found = 0;
for (const file of process.argv.slice(2)) {
  for (const { code, message, start_location: at } of workspace.check(readFileSync(file, 'utf8'))) {
    if (file.endsWith('.pyi') && code === 'F821') continue; // stubs may name what comes later
    console.log(`${file}:${at.row}:${at.column}: ${code ?? 'syntax'} ${message}`);
    ++found;
  }
}
process.exit(found > 0 ? 1 : 0);
