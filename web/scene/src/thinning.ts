// Too many points for this machine to draw in time: while the picture moves only every 2nd, 4th, … is drawn; once it is still, all are.
import type { PointLayer } from './points.ts';

const SLOW = 80; // ms from picture to picture: thin more
const FAST = 35; // thin less
const STILL = 250; // ms without a new picture before all is drawn
const SOON = 100; // ms after a picture: who asks for the next one by then is in motion, and waits for the drawing only
const FEW = 20000; // points that are never thinned: any machine draws them
const AT_FIRST = 100000; // points while moving, until the machine has shown that it can draw more
const MOST = 64;

export class Thinning {
  private step = 1;
  private last = 0; // time of the last picture
  private asked = 0; // time the next one was asked for
  private timer: ReturnType<typeof setTimeout> | undefined;
  private full = false; // the next picture is the one for which the timer asked
  private wasFull = false;
  private tried = 0; // number of points that AT_FIRST was applied to

  constructor(private readonly layers: readonly PointLayer[], private readonly invalidate: () => void) {}

  // The next picture is asked for. Whatever moves goes before the picture with all points.
  request(now: number): void {
    this.asked = now;
    if (!this.full) clearTimeout(this.timer);
  }

  // Before each picture.
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
      // A slow machine is not still while it draws.
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
