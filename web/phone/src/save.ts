// Dialog to save results: downloads each file, or shares it with another app where the browser supports this.
import { byId, make } from '../../shared/src/dom.ts';

export interface Offer { name: string; what: string; bytes(): Promise<Blob> }

export function download(blob: Blob, name: string): void {
  const link = make('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60e3);
}

export function showOffers(offers: readonly Offer[], note: string, failed: (text: string) => void): void {
  const list = byId('files');
  list.replaceChildren(...offers.map(({ name, what, bytes }) => {
    const row = make('li');
    const text = make('span', what, 'grow');
    const save = make('button', name);
    save.type = 'button';
    const say = (error: Error) => failed(`${name} could not be made: ${error.message}.`);
    save.addEventListener('click', () => void bytes().then((blob) => download(blob, name)).catch(say));
    row.append(text, save);
    if (canShare(name)) {
      const share = make('button', 'Share');
      share.type = 'button';
      share.setAttribute('aria-label', `Share ${name}`);
      share.addEventListener('click', () => void bytes().then((blob) => navigator.share({ files: [asFile(blob, name)] })).catch((error: Error) => {
        if (error.name !== 'AbortError') say(error);
      }));
      row.append(share);
    }
    return row;
  }));
  byId('save-note').textContent = note;
  (byId('save') as HTMLDialogElement).showModal();
}

// Browsers share only a few file types; others are shared as text or plain bytes.
function asFile(blob: Blob, name: string): File {
  return new File([blob], name, { type: name.endsWith('.txt') ? 'text/plain' : blob.type || 'application/octet-stream' });
}

function canShare(name: string): boolean {
  return Boolean(navigator.canShare?.({ files: [asFile(new Blob(['']), name)] }));
}
