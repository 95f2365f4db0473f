// The user's choices, stored on the device.
import { byId } from '../../shared/src/dom.ts';

export interface Choices {
  fov: number | null; // horizontal, degrees; null: self-calibrated
  shape: boolean; moving: boolean; features: boolean; focus: boolean; connected: boolean;
  more: string; // name=value lines
  detector: { name: string; classes: readonly string[] } | null; // describes the stored file (detector_file.ts)
}

const KEY = 'alidade-phone';
export const DEFAULTS: Choices = { fov: null, shape: false, moving: false, features: true, focus: true, connected: false, more: '', detector: null };

export function load(): Choices {
  try {
    const kept = JSON.parse(localStorage.getItem(KEY) ?? '{}') as Partial<Choices>;
    return { ...DEFAULTS, ...kept };
  } catch {
    return { ...DEFAULTS }; // storage is disabled or has other content
  }
}

export function keep(choices: Choices): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(choices));
  } catch {
    // storage is disabled: not stored
  }
}

// Class names of the active detector; none unless moving objects are excluded.
export function detectorClasses({ moving, detector }: Choices): readonly string[] { return moving ? detector?.classes ?? [] : []; }

// As after --set of the program.
export function coreSettings(choices: Choices): Record<string, string | number | boolean> {
  const settings: Record<string, string | number | boolean> = {};
  if (choices.shape) settings['semidense.enabled'] = true;
  if (choices.moving) settings['dynamics.mode'] = 'geometry';
  for (const line of choices.more.split('\n')) {
    const equal = line.indexOf('=');
    if (equal > 0) settings[line.slice(0, equal).trim()] = line.slice(equal + 1).trim();
  }
  return settings;
}

// Fills the dialog and stores changes.
export function bind(choices: Choices, changed: () => void): void {
  const box = (name: 'shape' | 'moving' | 'features' | 'focus' | 'connected') => {
    const input = byId('set-' + name) as HTMLInputElement;
    input.checked = choices[name];
    input.addEventListener('change', () => {
      choices[name] = input.checked;
      keep(choices);
      changed();
    });
  };
  for (const name of ['shape', 'moving', 'features', 'focus', 'connected'] as const) box(name);
  const fov = byId('set-fov') as HTMLInputElement;
  fov.value = choices.fov === null ? '' : String(choices.fov);
  fov.addEventListener('change', () => {
    choices.fov = fov.value === '' || !fov.validity.valid ? null : fov.valueAsNumber;
    keep(choices);
    changed();
  });
  const more = byId('set-more') as HTMLTextAreaElement;
  more.value = choices.more;
  more.addEventListener('change', () => {
    choices.more = more.value;
    keep(choices);
    changed();
  });
}
