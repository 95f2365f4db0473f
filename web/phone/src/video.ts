// Images of a video file, one by one, at the speed of processing.
import { DecodedVideo } from './decoded_video.ts';
import { PlayedVideo } from './played_video.ts';

export interface Picture { bitmap: ImageBitmap; time: number } // seconds

export interface Video {
  readonly width: number; // of the images as displayed, pixels
  readonly height: number;
  readonly duration: number; // seconds
  next(): Promise<Picture | null>; // null: the end. Throws Error with a text for users
  close(): void;
}

// Decodes the file where the browser can; else plays it in `element`. Throws Error with a text for users.
export async function openVideo(element: HTMLVideoElement, file: Blob): Promise<Video> {
  return await DecodedVideo.open(file) ?? await PlayedVideo.open(element, file);
}
