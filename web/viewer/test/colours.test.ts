// Kinds of marks in the camera image are distinguishable, also for color-blind users.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';

declare const WEB: string; // defined by tools/test.mjs

// Matrices on linear RGB that simulate the loss of one kind of cone: Machado, Oliveira & Fernandes 2009, severity 1.
const SIGHT: Record<string, number[]> = {
  all: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};

const times = (m: number[], v: number[]) => [0, 1, 2].map((r) => m[3 * r] * v[0] + m[3 * r + 1] * v[1] + m[3 * r + 2] * v[2]);

function linear(hex: string): number[] {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
}

function lab(rgb: number[]): number[] {
  const xyz = times([0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505], rgb.map((c) => Math.min(1, Math.max(0, c))));
  const [x, y, z] = xyz.map((value, k) => value / [0.9505, 1, 1.089][k]).map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

test('marks of different kinds are at least 20 apart in CIELAB, whatever cones one has', () => {
  const css = readFileSync(join(WEB, 'shared/src/palette.css'), 'utf8');
  const kinds = ['matched', 'fresh', 'moving', 'things'];
  const colours = kinds.map((kind) => linear(new RegExp(`--${kind}: (#[0-9a-f]{6})`).exec(css)![1]));
  for (const [name, sight] of Object.entries(SIGHT)) {
    const seen = colours.map((colour) => lab(times(sight, colour)));
    for (let a = 0; a < kinds.length; ++a) {
      for (let b = 0; b < a; ++b) {
        const apart = Math.hypot(...seen[a].map((value, k) => value - seen[b][k]));
        assert.ok(apart > 20, `${kinds[a]} and ${kinds[b]}: ${apart.toFixed(1)} for ${name}`);
      }
    }
  }
});
