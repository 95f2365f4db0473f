// Lengths of the map in words, once they are meters, and what is missing until then.
import type { State } from '@alidade/scene';
import { sentence } from '../../shared/src/words.ts';
import type { PageState } from './page_state.ts';
import type { Length } from './ruler.ts';

export const CUBE_EDGE = 0.1; // meters

const MOVE = 'Lengths are not known yet: move the phone sideways and back, with stops and turns.';

// Why lengths are not meters, and what to do; '': they are.
export function missingScale({ session, motion, progress, shown }: PageState): string {
  if (shown?.inertial?.metric) return '';
  if (session?.remote) return 'The computer that makes the map does not get the phone\'s motion: lengths have no unit.';
  if (progress) return 'A video has no motion sensor: lengths have no unit.';
  if (motion === 'refused') return 'The motion sensor was refused: lengths have no unit. Allow it for this page, then start anew.';
  if (motion === 'none') return 'This device has no motion sensor: lengths have no unit.';
  if (shown?.inertial?.leftOut) return sentence(shown.inertial.leftOut);
  return MOVE;
}

// Below 3 m in centimeters, rounded as the standard deviation allows.
export function lengthText({ length, sigma }: Length): string {
  const [factor, unit, least] = length < 3 ? [100, 'cm', 1] : [1, 'm', 2];
  const text = (value: number, digits: number) => (value * factor).toFixed(digits);
  if (!Number.isFinite(sigma)) return `about ${text(length, least - 1)} ${unit}`;
  const digits = length < 3 && sigma >= 0.01 ? 0 : least;
  return `${text(length, digits)} ± ${text(sigma, digits)} ${unit}`;
}

// What the ruler says; '': it is not in use.
export function rulerText(state: PageState): string {
  if (!state.measuring) return '';
  const missing = missingScale(state);
  if (missing) return missing;
  const ends = state.ruler?.landmarks.length ?? 0;
  if (ends === 0) return 'Tap two points to measure between them.';
  if (ends === 1) return 'Tap the second point.';
  const { measured } = state;
  if (!measured) return '';
  if (!Number.isFinite(measured.sigma)) return `The distance is ${lengthText(measured)}: look at both points from another place.`;
  return `The distance is ${lengthText(measured)}.`;
}

// Of the path through the keyframes of the active map, in the order of time.
export function pathLength(map: State): number {
  const active = map.activeMap;
  const along = [...map.keyframes.values()].filter((keyframe) => keyframe.map === active).sort((a, b) => a.number - b.number);
  let length = 0;
  along.forEach(({ T_world_camera: b }, i) => {
    const a = along[Math.max(0, i - 1)]!.T_world_camera;
    length += Math.hypot(b[4]! - a[4]!, b[5]! - a[5]!, b[6]! - a[6]!);
  });
  return length;
}

// '': lengths are not known.
export function pathText({ shown, map }: PageState): string {
  const inertial = shown?.inertial;
  if (!inertial?.metric) return '';
  const length = pathLength(map);
  return `Path ${length.toFixed(1)} m ± ${(100 * inertial.scaleSigma).toFixed(0)} %`;
}
