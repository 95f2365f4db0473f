// Short texts for phone users: the core's state, and what to do.
import type { Failure, Frame } from '../../core/src/index.ts';
import { sentence, STATE_WORDS } from '../../shared/src/words.ts';
import { CUBE_EDGE, rulerText } from './lengths.ts';
import type { PageState } from './page_state.ts';

const DARK = 35; // mean gray level, 0…255

// What helps against each failure.
const ADVICE: Readonly<Record<Failure, string>> = {
  first_view: 'Move sideways, slowly.',
  few_corners: 'Show it something with texture.',
  few_matches: 'Move more slowly.',
  little_motion: 'Move sideways, slowly.',
  no_motion_model: 'Move slowly; keep people out of the image.',
  low_parallax: 'Move sideways: rotation is not enough.',
  pure_rotation: 'Move sideways: rotation is not enough.',
  two_motions: 'Show it something with depth: the scene is flat.',
  still_camera: 'Move the phone, not the objects in front of it.',
  not_confirmed: 'Move slowly; keep people out of the image.',
  moving_start: 'Move slowly; keep people out of the image.',
  few_depths: 'Move closer to something with texture.',
  few_near_depths: 'Move closer to something with texture.',
  few_landmarks: 'Go back slowly to a mapped place.',
  not_recognized: 'Go back to a mapped place, and look in the same direction.',
  unknown_scale: 'Move sideways while rotating.',
  mapping_stopped: 'No new map can be started: stop, and start again.',
};

// `light`: mean gray level of the image; NaN: unknown.
export function advice({ state, failure, reason, predicted }: Frame, light: number): string {
  if (state === 'tracking') return light < DARK ? 'It is dark: more light would help.' : '';
  if (predicted) return 'Just lost: the pose is predicted from the last motion.';
  if (light < DARK) return 'Too dark: switch on a light.';
  return failure ? ADVICE[failure] : sentence(reason);
}

// Where the images of the next session go; the user reads it before the camera starts. `host`: of the page.
export function whereText({ remote, info }: PageState, host: string): string {
  if (remote) return `The images are sent to the computer that serves this page (${host}), which makes the map.`;
  const choice = info?.connected ? ' In Settings you can let the computer that serves this page make the map: then the images are sent there.' : '';
  return `The images stay on this device: nothing is uploaded.${choice}`;
}

export function statusOf(state: PageState): { word: string; advice: string } {
  const { phase, why, session, shown, cube, savable } = state;
  if (phase === 'ended') {
    const results = !savable ? 'There is no map to save.' : session?.remote ? 'The computer that serves this page has the map.' : 'The results can be saved.';
    return { word: 'Ended', advice: why ? '' : results };
  }
  if (shown) {
    const { frame, light } = shown;
    const tap = frame.state === 'tracking' && !cube && frame.counts.keyframes > 3;
    const size = shown.inertial?.metric ? ` of ${100 * CUBE_EDGE} cm` : '';
    return { word: STATE_WORDS[frame.state], advice: advice(frame, light) || rulerText(state) || (tap ? `Tap a surface to put a cube${size} on it.` : '') };
  }
  if (session) return { word: 'Loading', advice: session.remote ? 'Connecting to the computer that makes the map …' : 'The core (4 MB, the first time) …' };
  return { word: 'Ready', advice: '' };
}

// Horizontal field of view of the processed images.
export function lensText({ fov, fovSigma }: Frame, given: boolean): string {
  if (!(fov > 0)) return '';
  if (given) return `Field of view ${fov.toFixed(0)}°, given`;
  return `Field of view ${fovSigma > 5 ? `${fov.toFixed(0)}°, assumed` : `${fov.toFixed(1)}° ± ${fovSigma.toFixed(1)}°, found`}`;
}
