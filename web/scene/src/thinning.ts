// Too many points for this machine to draw in time: while the picture moves only every 2nd, 4th, … is drawn; once it is still, all are.
import type { PointLayer } from './points.ts';

const SLOW = 80; // ms between pictures: thin more
const FAST = 35; // thin less
const STILL = 250; // ms without a new picture before all is drawn
const FEW = 40000; // points that are never thinned: any machine draws them

export class Thinning {
  private step = 1;
  private last = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private full = false;

  constructor(private readonly layers: readonly PointLayer[], private readonly invalidate: () => void) {}

  // Before each picture.
  before(now: number): void {
    const interval = now - this.last;
    this.last = now;
    const count = this.layers.reduce((sum, layer) => sum + layer.count, 0);
    if (this.full) {
      // The picture that was asked for by the timer below.
      this.full = false;
      this.apply(1);
      return;
    }
    // Long pauses say nothing: pictures are made when asked for.
    if (interval > SLOW && interval < 2 * STILL && count / this.step > FEW) this.step = Math.min(64, 2 * this.step);
    else if (interval < FAST && this.step > 1) this.step /= 2;
    this.apply(this.step);
    clearTimeout(this.timer);
    if (this.step > 1) {
      this.timer = setTimeout(() => {
        this.full = true;
        this.invalidate();
      }, STILL);
    }
  }

  private apply(step: number): void {
    for (const layer of this.layers) layer.thin(step);
  }
}
