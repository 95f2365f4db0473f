// Lengths in words. `unit`: of the stream, "m" or "map units".

export function lengthText(length: number, unit: string): string {
  if (unit !== 'm') return `${length >= 1000 || length < 0.001 ? Number(length.toPrecision(3)) : length.toPrecision(3)} ${unit}`;
  if (length >= 1) return `${length.toFixed(2)} m`;
  return length >= 0.01 ? `${(100 * length).toFixed(1)} cm` : `${(1000 * length).toFixed(1)} mm`;
}

// The longest of 1, 2, 5, 10, … that is not longer than `most`.
export function roundLength(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  return (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1) * power;
}

// Of a round length.
export function roundText(length: number, unit: string): string {
  if (unit === 'm' && length < 1) return length >= 0.01 ? `${Number((100 * length).toPrecision(1))} cm` : `${Number((1000 * length).toPrecision(1))} mm`;
  const number = Number(length.toPrecision(1));
  return unit === 'm' || number !== 1 ? `${number} ${unit}` : `1 ${unit.replace(/s$/, '')}`;
}
