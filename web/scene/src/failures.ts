// Why a frame has no pose, in the words of src/alidade/tracking/track_failure.cc.
import { FAILURES, REASONS } from '../generated/failures.ts';
import type { Failure } from '../generated/failures.ts';

export { FAILURES, REASONS };
export type { Failure };

// Words of Alidade 0.1 that were changed since.
const OLD_WORDS: Readonly<Record<string, Failure>> = {
  'the place was not recognised': 'not_recognized',
  'no frame yet': 'first_view',
  'too few points agree on one motion': 'no_motion_model',
  'a turn on the spot explains what is seen: move the camera sideways': 'pure_rotation',
  'two motions explain what is seen': 'two_motions',
  'something moves, the camera seems to stand still': 'still_camera',
  'the first points did not hold': 'not_confirmed',
  'the first points moved': 'moving_start',
  'too few corners near enough for the sensor to place': 'few_near_depths',
  'a turn left no scale: move sideways while turning': 'unknown_scale',
};

// Of words as streams and answers of Alidade 0.1 have them; null: unknown.
export function failureWithReason(words: string): Failure | null {
  return FAILURES.find((failure) => REASONS[failure] === words) ?? OLD_WORDS[words] ?? null;
}
