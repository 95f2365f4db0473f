// Texts for users: what the program is doing, and what to do.
import type { Event, Failure, Frame, State } from '@alidade/scene';
import { sentence } from '../../shared/src/words.ts';

// What helps against each failure.
const ADVICE: Readonly<Record<Failure, string>> = {
  first_view: 'Move the camera sideways, slowly.',
  few_corners: 'Show it something with texture, or add light.',
  few_matches: 'Move more slowly, or add light.',
  little_motion: 'Move the camera sideways, slowly.',
  no_motion_model: 'Move more slowly, and keep moving objects out of the image.',
  low_parallax: 'Rotation is not enough: the camera has to see the scene from another place.',
  pure_rotation: 'Rotation is not enough: the camera has to see the scene from another place.',
  two_motions: 'The scene is flat: show it something with depth.',
  still_camera: 'The camera itself has to move, not the objects in front of it.',
  not_confirmed: 'Keep moving sideways, slowly.',
  moving_start: 'Keep moving objects out of the image.',
  few_depths: 'Show it something with texture, within the range of the depth camera.',
  few_near_depths: 'Move closer to something with texture.',
  few_landmarks: 'The image may be blurred, covered or without texture: go back slowly to a mapped place.',
  not_recognized: 'Go back to a place that was mapped, and look in the same direction.',
  unknown_scale: 'Move sideways while rotating.',
  mapping_stopped: 'The terminal of the program shows the cause.',
};

export function advice(failure: Failure | null): string {
  return failure ? ADVICE[failure] : '';
}

export function reasonText(frame: Frame): string {
  if (frame.state === 'tracking') return '';
  const guess = frame.predicted ? 'The camera is drawn at the pose predicted from its last motion.' : '';
  return [sentence(frame.reason), guess || advice(frame.failure)].filter(Boolean).join(' ');
}

// For the end of the run.
export function endText({ hello, frame, latest, keyframes }: State): { word: string; reason: string } {
  if (!frame && hello && hello.frames < 0 && !hello.live) return { word: 'Map', reason: 'As saved.' };
  const why = sentence(frame?.reason ?? '');
  if (latest?.state === 'tracking') return { word: 'Ended', reason: 'Tracked to the last frame.' };
  if (keyframes.size === 0) return { word: 'Ended', reason: `It did not start. ${why}`.trimEnd() };
  return { word: 'Ended', reason: `Lost at the last frame. ${why}`.trimEnd() };
}

export function clock(seconds: number): string {
  if (!Number.isFinite(seconds)) return '–';
  const whole = Math.max(0, seconds);
  return `${Math.floor(whole / 60)}:${(whole % 60).toFixed(1).padStart(4, '0')}`;
}

export const EVENT_WORDS = {
  waiting: 'Not started', started: 'Started', lost: 'Lost', found: 'Relocalized', loop: 'Loop closed', merge: 'Maps merged',
  new_map: 'New map', given_up: 'Map dropped', cut: 'Cut in the recording', warning: 'Warning', finished: 'Finished',
} as const;

// Some event texts already contain the kind of event.
export function eventText({ what, text }: Event): string {
  const word = EVENT_WORDS[what];
  if (!text || text.toLowerCase() === word.toLowerCase()) return word;
  return text.toLowerCase().startsWith(`${word.toLowerCase()}: `) ? text.charAt(0).toUpperCase() + text.slice(1) : `${word}: ${text}`;
}
