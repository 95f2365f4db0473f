// Short texts for phone users: the core's state, and what to do.
import type { Frame } from '../../core/src/index.ts';
import { sentence, STATE_WORDS } from '../../shared/src/words.ts';
import type { PageState } from './page_state.ts';

const DARK = 35; // mean gray level, 0…255

const ADVICE: readonly [RegExp, string][] = [
  [/hardly moves/, 'Move sideways, slowly.'],
  [/too little parallax|turn on the spot/, 'Move sideways: turning is not enough.'],
  [/stand still/, 'Move the phone, not the things before it.'],
  [/two motions explain/, 'Show it something with depth: what is seen is flat.'],
  [/no frame yet/, 'Move sideways, slowly.'],
  [/too few matches between frames/, 'Move more slowly.'],
  [/too few points agree|did not hold|first points moved/, 'Move slowly; keep people out of the picture.'],
  [/too few corners/, 'Nothing to hold on to: show it something with texture.'],
  [/not recognised/, 'Go back to a place it has seen, and look the same way.'],
  [/too few landmarks found/, 'Go back slowly to what it has seen.'],
];

// `light`: mean gray level of the image; NaN: unknown.
export function advice({ state, reason, predicted }: Frame, light: number): string {
  if (state === 'tracking') return light < DARK ? 'It is dark: more light would help.' : '';
  if (predicted) return 'Hold on: it guesses where you are.';
  if (light < DARK) return 'Too dark: switch on a light.';
  const found = ADVICE.find(([pattern]) => pattern.test(reason));
  return found?.[1] ?? sentence(reason);
}

// Where the images of the next session go; the user reads it before the camera starts. `host`: of the page.
export function whereText({ remote, info }: PageState, host: string): string {
  if (remote) return `The images are sent to the computer that serves this page (${host}), which makes the map.`;
  const choice = info?.connected ? ' In Settings you can let the computer that serves this page make the map: then the images are sent there.' : '';
  return `The images stay on this device: nothing is uploaded.${choice}`;
}

export function statusOf({ phase, why, session, shown, cube }: PageState): { word: string; advice: string } {
  if (phase === 'ended') return { word: 'Ended', advice: why ? '' : 'What there is can be saved.' };
  if (shown) {
    const { frame, light } = shown;
    const tap = frame.state === 'tracking' && !cube && frame.counts.keyframes > 3;
    return { word: STATE_WORDS[frame.state], advice: advice(frame, light) || (tap ? 'Tap a surface to put a cube on it.' : '') };
  }
  if (session) return { word: 'Loading', advice: session.remote ? 'Asking for the computer that does the work …' : 'The core (4 MB, the first time) …' };
  return { word: 'Ready', advice: '' };
}

export function lensText({ fov, fovSigma }: Frame, given: boolean): string {
  if (!(fov > 0)) return '';
  if (given) return `${fov.toFixed(0)}° given`;
  return fovSigma > 5 ? `${fov.toFixed(0)}° assumed` : `${fov.toFixed(1)}° ± ${fovSigma.toFixed(1)} found`;
}
