// Light or dark theme: the system's until the user chooses.
import { byId } from '../../shared/src/dom.ts';

const KEY = 'alidade-theme';

export function onTheme(changed: () => void): void {
  const root = document.documentElement;
  const system = matchMedia('(prefers-color-scheme: dark)');
  let chosen: string | null = null;
  try {
    chosen = localStorage.getItem(KEY);
  } catch {
    // storage is disabled: the choice is not stored
  }
  const apply = () => {
    root.dataset.theme = chosen ?? (system.matches ? 'dark' : 'light');
    changed();
  };
  system.addEventListener('change', apply);
  byId('theme').addEventListener('click', () => {
    chosen = root.dataset.theme === 'dark' ? 'light' : 'dark';
    try {
      localStorage.setItem(KEY, chosen);
    } catch {
      // as above
    }
    apply();
  });
  apply();
}
