// docs/reference/javascript.md is what its generator prints.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';

declare const WEB: string; // defined by tools/test.mjs

test('the reference page of the JavaScript package is up to date', () => {
  const printed = execFileSync(process.execPath, [join(WEB, 'tools/reference.mjs')], { encoding: 'utf8' });
  const page = readFileSync(join(WEB, '../docs/reference/javascript.md'), 'utf8');
  assert.equal(page, printed, 'regenerate it: scripts/docs');
});
