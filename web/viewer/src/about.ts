import { byId, make } from '../../shared/src/dom.ts';

declare const BUNDLED: readonly { name: string; version: string; licence: string }[]; // defined by tools/build.mjs

export function fillAbout(): void {
  const list = byId('about-bundled');
  for (const { name, version, licence } of BUNDLED) list.append(make('li', `${name} ${version}, ${licence}`));
  byId('about-open').addEventListener('click', () => (byId('about') as HTMLDialogElement).showModal());
}
