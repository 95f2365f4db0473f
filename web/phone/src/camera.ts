// Opens the phone's camera and fixes its focus; errors are explained for users.

export class CameraProblem extends Error {}

const PROBLEMS: Record<string, string> = {
  NotAllowedError: 'The browser denied the camera. Allow it for this page (lock or camera symbol next to the address), then press Start again. A video can be opened without it.',
  NotFoundError: 'No camera was found. A video can be opened instead.',
  NotReadableError: 'The camera is in use by another app, or does not answer. Close other apps that use it, then press Start again.',
  OverconstrainedError: 'No camera supports the requested size. A video can be opened instead.',
};

interface FocusCapabilities extends MediaTrackCapabilities { focusMode?: string[]; focusDistance?: { min: number; max: number } }
interface FocusSettings extends MediaTrackSettings { focusDistance?: number }

// Prefers the rear camera.
export async function openCamera(): Promise<MediaStream> {
  if (!navigator.mediaDevices) {
    throw new CameraProblem(isSecureContext ? 'This browser does not support cameras in pages. A video can be opened instead.'
      : 'Browsers allow the camera only on https pages and on localhost: start the program with --tls. A video can be opened instead.');
  }
  try {
    return await navigator.mediaDevices.getUserMedia({
      audio: false, video: { facingMode: { ideal: 'environment' }, width: { ideal: 640 }, height: { ideal: 480 }, frameRate: { ideal: 30 } },
    });
  } catch (error) {
    const { name, message } = error as DOMException;
    throw new CameraProblem(PROBLEMS[name] ?? `The camera could not be opened: ${message}.`);
  }
}

const SETTLING = 1500; // milliseconds for the lens to focus by itself before the focus is fixed

// Fixes the focus, because focusing changes the focal length by one or two percent. Returns whether it is fixed.
export async function holdFocus(stream: MediaStream): Promise<boolean> {
  const track = stream.getVideoTracks()[0];
  const can = (track?.getCapabilities?.() ?? {}) as FocusCapabilities;
  if (!track || !can.focusMode?.includes('manual')) return false;
  await new Promise((resolve) => { setTimeout(resolve, SETTLING); });
  if (track.readyState !== 'live') return false;
  const { focusDistance } = track.getSettings() as FocusSettings;
  try {
    await track.applyConstraints({ advanced: [{ focusMode: 'manual', ...(focusDistance === undefined ? {} : { focusDistance }) } as MediaTrackConstraintSet] });
    return true;
  } catch {
    return false;
  }
}

const AREA = 400 * 300; // pixels of a processed image: the phone profile's 400 columns of a 4:3 landscape image
const FEWEST = 64;

// Scaled size with the image's aspect ratio; even numbers.
export function workingSize(width: number, height: number): { width: number; height: number } {
  const scale = Math.min(1, Math.sqrt(AREA / (width * height)));
  const even = (length: number) => Math.max(FEWEST, 2 * Math.round((length * scale) / 2));
  return { width: even(width), height: even(height) };
}
