// Texts for users: what the program is doing, and what to do.
import type { Event, Frame, State } from '@alidade/scene';
import { sentence } from '../../shared/src/words.ts';

const ADVICE: readonly [RegExp, string][] = [
  [/hardly moves/, 'Move the camera sideways, slowly.'],
  [/too little parallax/, 'Turning is not enough: it has to see things from another place.'],
  [/turn on the spot explains/, 'Turning is not enough: it has to see things from another place.'],
  [/camera seems to stand still/, 'The camera itself has to move, not the things before it.'],
  [/two motions explain/, 'What is seen is flat: show it something with depth.'],
  [/too few matches between frames/, 'Move more slowly, or add light.'],
  [/too few points agree/, 'Move more slowly, and keep moving things out of the picture.'],
  [/too few corners with depth/, 'Show it something with texture, within the range of the depth camera.'],
  [/too few corners/, 'Nothing to hold on to: show it something with texture, or add light.'],
  [/not recognised/, 'Go back to a place it has seen, and look the same way.'],
  [/too few landmarks found/, 'Blurred, covered, or a blank wall: go back slowly to what it has seen.'],
  [/mapping has stopped/, 'The program says why on its terminal.'],
];

export function advice(reason: string): string {
  return ADVICE.find(([pattern]) => pattern.test(reason))?.[1] ?? '';
}

export function reasonText(frame: Frame): string {
  if (frame.state === 'tracking') return '';
  const guess = frame.predicted ? 'Shown where its motion leads.' : '';
  return [sentence(frame.reason), guess || advice(frame.reason)].filter(Boolean).join(' ');
}

// For the end of the run.
export function endText({ hello, frame, latest, keyframes }: State): { word: string; reason: string } {
  if (!frame && hello && hello.frames < 0 && !hello.live) return { word: 'Map', reason: 'As it was saved.' };
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
  waiting: 'Not started', started: 'Started', lost: 'Lost', found: 'Found again', loop: 'Loop closed', merge: 'Maps merged',
  new_map: 'New map', given_up: 'Map given up', cut: 'Cut in the recording', warning: 'Warning', finished: 'Finished',
} as const;

// Some event texts already contain the kind of event.
export function eventText({ what, text }: Event): string {
  const word = EVENT_WORDS[what];
  if (!text || text.toLowerCase() === word.toLowerCase()) return word;
  return text.toLowerCase().startsWith(`${word.toLowerCase()}: `) ? text.charAt(0).toUpperCase() + text.slice(1) : `${word}: ${text}`;
}
