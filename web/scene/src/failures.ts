// Why a frame has no pose, in the words of src/alidade/tracking/track_failure.cc.
import { FAILURES, REASONS } from '../generated/failures.ts';
import type { Failure } from '../generated/failures.ts';

export { FAILURES, REASONS };
export type { Failure };

// Words of Alidade 0.1 that were changed since.
const OLD_WORDS: Readonly<Record<string, Failure>> = {
  'the place was not recognised': 'not_recognized',
};

// Of words as streams and answers of Alidade 0.1 have them; null: unknown.
export function failureWithReason(words: string): Failure | null {
  return FAILURES.find((failure) => REASONS[failure] === words) ?? OLD_WORDS[words] ?? null;
}
