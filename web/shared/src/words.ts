// Texts that the pages have in common.
import type { TrackingState } from '@alidade/scene';

export const STATE_WORDS: Record<TrackingState, string> = { initializing: 'Starting', tracking: 'Tracking', lost: 'Lost' };

// "the camera hardly moves" → "The camera hardly moves."
export function sentence(text: string): string {
  return text && `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;
}
