import { byId, make } from '../../shared/src/dom.ts';

type Key = readonly [key: string, name: string, what: string, act: () => void];

export function keys(all: readonly Key[]): void {
  for (const [, name, what] of all) {
    const row = make('tr');
    const cell = make('td');
    cell.append(make('kbd', name));
    row.append(cell, make('td', what));
    byId('keys-table').append(row);
  }
  byId('keys-open').addEventListener('click', () => (byId('keys') as HTMLDialogElement).showModal());
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || document.querySelector('dialog[open]')) return;
    const target = event.target as HTMLElement;
    if (target.closest('select')) return;
    // These elements react to the space bar themselves.
    if (event.key === ' ' && target.closest('button, input[type=checkbox]')) return;
    const key = all.find(([name]) => name === event.key.toLowerCase());
    if (!key) return;
    event.preventDefault();
    key[3]();
  });
}
