// The device's inertial sensor (W3C DeviceMotion) as readings for the core: rad/s and m/s² in the device's own axes (x
// right, y up, z out of the screen, however the screen is turned), on the clock of the camera's images. How the camera
// sits in these axes, and the constant delay of the images, are estimated by the core.

const DEGREE = Math.PI / 180;
const FIRST = 10; // images from which the difference of the clocks is taken
const JUMP = 0.3; // seconds: a difference of the clocks that changed by more, in FIRST images in a row, is a new one
const MOST = 6000; // readings kept while no image is processed: half a minute at 200 Hz
const FACING = 0.5; // cosine of the angle between force and vertical from which the sign is certain

export type MotionState = 'none' | 'refused' | 'waiting' | 'on'; // waiting: no reading has come yet

interface Asking { requestPermission?(): Promise<string> }

// iOS asks the user, and only within the event of a tap: call it before anything is awaited.
async function permitted(): Promise<boolean> {
  const asking = [globalThis.DeviceMotionEvent, globalThis.DeviceOrientationEvent] as unknown as (Asking | undefined)[];
  try {
    const answers = await Promise.all(asking.map(async (of) => of?.requestPermission?.() ?? 'granted'));
    return answers[0] === 'granted';
  } catch {
    return false;
  }
}

export class Motion {
  state: MotionState;
  private pending: number[][] = []; // seconds of the page's clock (performance.now()), 6 values
  private difference: number | null = null; // page's clock minus the images', seconds; null: not known yet
  private readonly first: number[] = [];
  private changed: number[] = [];
  // Safari's accelerations have the opposite sign of the specification's, so that of a device that lies on its back
  // points into the table. DeviceOrientation tells in every browser which way is up (its beta and gamma have one
  // definition), so the sign is what the two say together; until it has told, that of Safari's engine (`vendor`).
  private up: readonly [number, number, number] | null = null; // in the device's axes
  private votes = 0; // positive: the signs of the specification

  private constructor(granted: boolean, private readonly vendor: string) {
    this.state = !granted ? 'refused' : 'DeviceMotionEvent' in globalThis ? 'waiting' : 'none';
    if (this.state !== 'waiting') return;
    window.addEventListener('devicemotion', this.moved);
    window.addEventListener('deviceorientation', this.turned);
  }

  // Call it within the event of a tap.
  static async open(vendor: string = navigator.vendor): Promise<Motion> {
    return new Motion(await permitted(), vendor);
  }

  close(): void {
    window.removeEventListener('devicemotion', this.moved);
    window.removeEventListener('deviceorientation', this.turned);
  }

  // An image of `time` (seconds, its own clock) was taken at `at` (seconds of the page's clock; a little late).
  image(time: number, at: number): void {
    if (this.state === 'waiting' && this.first.length >= 10 * FIRST) this.state = 'none';
    const now = at - time;
    if (this.first.length < 10 * FIRST) this.first.push(now);
    if (this.difference === null) {
      // The least is that with the least delay.
      if (this.first.length >= FIRST) this.difference = Math.min(...this.first);
      return;
    }
    // A camera that is opened again starts its clock anew.
    this.changed = Math.abs(now - this.difference) > JUMP ? [...this.changed, now] : [];
    if (this.changed.length < FIRST) return;
    this.difference = Math.min(...this.changed);
    this.changed = [];
  }

  // The readings since the last call, 7 numbers each (Slam.track()); empty until the clocks are known.
  take(): Float64Array {
    const { difference } = this;
    if (difference === null || this.pending.length === 0) return new Float64Array();
    const sign = this.sign;
    const taken = Float64Array.from(this.pending.flatMap(([t, wx, wy, wz, ax, ay, az]) => [t! - difference, wx!, wy!, wz!, sign * ax!, sign * ay!, sign * az!]));
    this.pending = [];
    return taken;
  }

  private get sign(): number {
    if (this.votes !== 0) return this.votes > 0 ? 1 : -1;
    return this.vendor.startsWith('Apple') ? -1 : 1;
  }

  private readonly moved = ({ timeStamp, accelerationIncludingGravity: a, rotationRate: r }: DeviceMotionEvent): void => {
    const values = [r?.beta, r?.gamma, r?.alpha, a?.x, a?.y, a?.z];
    if (values.some((value) => typeof value !== 'number')) return; // a computer without such a sensor sends nulls
    const [x, y, z, ax, ay, az] = values as number[];
    this.state = 'on';
    this.pending.push([timeStamp / 1000, x! * DEGREE, y! * DEGREE, z! * DEGREE, ax!, ay!, az!]);
    if (this.pending.length > MOST) this.pending.shift();
    this.vote(ax!, ay!, az!);
  };

  private vote(ax: number, ay: number, az: number): void {
    const length = Math.hypot(ax, ay, az);
    if (!this.up || length < 5 || Math.abs(this.votes) > 50) return;
    const cosine = (ax * this.up[0] + ay * this.up[1] + az * this.up[2]) / length;
    if (Math.abs(cosine) > FACING) this.votes += Math.sign(cosine);
  }

  // Up in the device's axes, from the intrinsic rotations z alpha, x beta, y gamma that turn the earth's axes into them.
  private readonly turned = ({ beta, gamma }: DeviceOrientationEvent): void => {
    if (typeof beta !== 'number' || typeof gamma !== 'number') return;
    const [b, g] = [beta * DEGREE, gamma * DEGREE];
    this.up = [-Math.cos(b) * Math.sin(g), Math.sin(b), Math.cos(b) * Math.cos(g)];
  };
}
