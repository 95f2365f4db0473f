// The engine's results as messages to the page's state.
import { decode, DecodeError } from '../../scene/src/decode.ts';
import type { Message } from '@alidade/scene';
import type { Hooks } from './engine.ts';
import type { Dispatch } from './page_state.ts';

// `ended`: called with a text for users when the engine has ended the session.
export function engineHooks(dispatch: Dispatch, ended: (why: string) => void): Hooks {
  const decoded = (messages: readonly Uint8Array[]): Message[] => messages.flatMap((bytes) => {
    try {
      return [decode(bytes)];
    } catch (error) {
      if (!(error instanceof DecodeError)) throw error;
      dispatch({ kind: 'notice', about: 'message', text: `A message of the core could not be read: ${error.message}.` });
      return [];
    }
  });
  return {
    done(done) { dispatch({ kind: 'done', done, messages: decoded(done.messages) }); },
    messages(messages) { dispatch({ kind: 'stream', messages: decoded(messages) }); },
    anew() { dispatch({ kind: 'anew' }); },
    failed(text) { ended(`The core has stopped: ${text}. The results so far can be saved; Start anew begins again.`); },
    lost(text) { dispatch({ kind: 'notice', about: 'connection', text }); },
  };
}
