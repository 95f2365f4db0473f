// Lengths in words, and the scale bar's round ones.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { lengthText, roundLength, roundText } from '../src/lengths.ts';

test('meters, centimeters, millimeters; map units as they are', () => {
  assert.deepEqual([12.345, 0.5, 0.004].map((length) => lengthText(length, 'm')), ['12.35 m', '50.0 cm', '4.0 mm']);
  assert.deepEqual([12.345, 1.2, 0.0456, 12345].map((length) => lengthText(length, 'map units')), ['12.3 map units', '1.20 map units', '0.0456 map units', '12300 map units']);
});

test('the bar has a round length, not longer than it may be', () => {
  for (const [most, length, text] of [[0.99, 0.5, '50 cm'], [1, 1, '1 m'], [0.0021, 0.002, '2 mm'], [0.3, 0.2, '20 cm'], [7, 5, '5 m'], [240, 200, '200 m']] as const) {
    assert.ok(Math.abs(roundLength(most) - length) < 1e-9 * length, `${most}: ${roundLength(most)}`);
    assert.equal(roundText(roundLength(most), 'm'), text);
  }
  assert.equal(roundText(0.2, 'map units'), '0.2 map units');
  assert.equal(roundText(1, 'map units'), '1 map unit');
});
