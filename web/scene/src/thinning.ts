// Adapts the number of drawn points to the machine's speed: while the view moves, every 2nd, 4th, … point is drawn; a
// still view shows all.
import type { PointLayer } from './points.ts';

const SLOW = 80; // ms between images: draw fewer points
const FAST = 35; // ms: draw more points
const STILL = 250; // ms without a new image before all points are drawn
// Milliseconds after an image: a request within this time means that the view is moving and is limited by drawing speed
// only.
const SOON = 100;
const FEW = 20000; // points that are never thinned
const AT_FIRST = 100000; // initial limit of points while moving, until the machine proves faster
const MOST = 64;

export class Thinning {
  private step = 1;
  private last = 0; // time of the last image
  private asked = 0; // time the next image was requested
  private timer: ReturnType<typeof setTimeout> | undefined;
  private full = false; // the next image is the still one requested by the timer
  private wasFull = false;
  private tried = 0; // number of points when AT_FIRST was last applied

  constructor(private readonly layers: readonly PointLayer[], private readonly invalidate: () => void) {}

  // Call when the next image is requested. Motion takes precedence over the still image with all points.
  request(now: number): void {
    this.asked = now;
    if (!this.full) clearTimeout(this.timer);
  }

  // Call before each image.
  before(now: number): void {
    const interval = now - this.last;
    const moving = this.asked - this.last < SOON && !this.wasFull;
    this.last = now;
    const count = this.layers.reduce((sum, layer) => sum + layer.count, 0);
    this.wasFull = this.full;
    if (this.full) {
      this.full = false;
      return this.apply(1);
    }
    if (count > 2 * this.tried && count / this.step > AT_FIRST) {
      this.tried = count;
      while (count / this.step > AT_FIRST) this.step *= 2;
    } else if (moving && interval > SLOW && count / this.step > FEW) {
      this.step = Math.min(MOST, 2 * this.step);
    } else if (moving && interval < FAST && this.step > 1) {
      this.step /= 2;
    }
    this.apply(this.step);
    clearTimeout(this.timer);
    if (this.step > 1) {
      // scale the delay with the drawing time, so that a slow machine is not considered still
      this.timer = setTimeout(() => {
        this.full = true;
        this.invalidate();
      }, Math.max(STILL, 2 * Math.min(interval, 1000)));
    }
  }

  apply(step: number): void {
    for (const layer of this.layers) layer.thin(step);
  }
}
