// What the user does: starts the camera or opens a video, stops, records, saves. Moves images from their source to the
// engine.
import { CameraProblem, workingSize } from './camera.ts';
import { CameraSource } from './camera_source.ts';
import { Cube } from './cube.ts';
import type { DetectorHost } from './detector.ts';
import { LocalEngine } from './engine.ts';
import type { Engine, Hooks } from './engine.ts';
import type { Point } from './lens.ts';
import { Motion } from './motion.ts';
import type { Dispatch, PageState } from './page_state.ts';
import { cameraYaml, Recorder } from './recorder.ts';
import { RemoteEngine } from './remote.ts';
import { Ruler } from './ruler.ts';
import { download, showOffers } from './save.ts';
import { engineHooks } from './session.ts';
import { coreSettings, detectorClasses } from './settings.ts';
import { openVideo } from './video.ts';
import type { Video } from './video.ts';
import { Wake } from './wake.ts';

const pause = (milliseconds: number) => new Promise<void>((resolve) => { setTimeout(resolve, milliseconds); });

export class Control {
  engine: Engine | null = null;
  private prepared: LocalEngine | null = null; // for the next session
  private camera: CameraSource | null = null;
  private file: Video | null = null;
  private motion: Motion | null = null;
  private recorder: Recorder | null = null;
  private readonly wake = new Wake();

  // `asked`: resolves when the server's capabilities are known.
  constructor(private readonly state: PageState, private readonly dispatch: Dispatch, private readonly video: HTMLVideoElement,
    private readonly detector: DetectorHost, private readonly asked: Promise<void>) {}

  // Loads the core before it is needed.
  prepare(): void {
    if (this.prepared || this.state.remote || this.state.info?.core === false) return;
    this.prepared = this.localEngine();
    this.prepared.prepare();
  }

  // Call it within the event of a tap, because of Motion.open().
  async startCamera(): Promise<void> {
    const motion = Motion.open();
    await this.asked;
    this.dispatch({ kind: 'opening', opening: true });
    try {
      this.camera = await CameraSource.open(this.video, {
        image: (time, at) => this.take(time, at),
        problem: (text) => this.notice(text, 'camera'),
      });
      this.dispatch({ kind: 'phase', phase: 'running' });
      this.motion = await motion;
      await this.begin(this.video.videoWidth, this.video.videoHeight);
      await this.wake.hold();
      this.camera.start(this.state.choices.focus);
    } catch (error) {
      void motion.then((opened) => opened.close());
      this.closeCamera();
      this.dispatch({ kind: 'phase', phase: 'idle' });
      this.notice(error instanceof CameraProblem ? error.message : `It could not start: ${(error as Error).message}.`, 'start');
    } finally {
      this.dispatch({ kind: 'opening', opening: false });
    }
  }

  async openFile(chosen: File): Promise<void> {
    this.closeCamera();
    this.closeFile();
    await this.asked;
    try {
      const opened = await openVideo(this.video, chosen);
      this.file = opened;
      this.dispatch({ kind: 'phase', phase: 'running' });
      await this.begin(opened.width, opened.height);
      await this.wake.hold();
      const goesOn = () => this.file === opened && this.state.phase === 'running';
      for (let next = await opened.next(); next && this.file === opened; next = await opened.next()) {
        while (!this.engine!.free && goesOn()) await pause(1);
        if (!goesOn()) {
          next.bitmap.close();
          return;
        }
        this.engine!.push(next.bitmap, next.time, 0, new Float64Array(), this.state.ruler?.landmarks ?? []);
        this.dispatch({ kind: 'progress', progress: { seconds: next.time, duration: opened.duration } });
      }
      while (this.engine && !this.engine.idle) await pause(5);
      if (this.file === opened) this.end('');
    } catch (error) {
      const { message } = error as Error;
      if (this.engine && this.state.shown) return this.end(`${chosen.name} could not be read to its end: ${message}. The results so far can be saved.`);
      this.closeFile();
      this.dispatch({ kind: 'phase', phase: 'idle' });
      this.notice(`${chosen.name} was not opened: ${message}.`, 'start');
    }
  }

  // `why`: reason for an abnormal end, or '': then the whole map is adjusted once more.
  end(why: string): void {
    if (this.state.phase !== 'running') return;
    if (this.recorder) void this.stopRecording('');
    this.closeCamera();
    this.closeFile();
    this.dispatch({ kind: 'phase', phase: 'ended', why });
    if (why) this.notice(why, 'end');
    else void this.engine?.ask('finish').catch((error: Error) => this.notice(`The last adjustment failed: ${error.message}.`, 'end'));
  }

  again(): void {
    this.engine?.close();
    this.engine = null;
    this.dispatch({ kind: 'reset' });
    this.dispatch({ kind: 'phase', phase: 'idle' });
    this.prepare();
  }

  tap(at: Point | null): void {
    if (!at || this.state.shown?.frame.state !== 'tracking') return;
    if (this.state.measuring) return this.measure(at);
    const placed = Cube.place(this.state.map, at);
    if (placed) this.dispatch({ kind: 'cube', cube: placed });
    this.notice(placed ? '' : 'There are no map points there yet: look at it a little longer.', 'cube');
  }

  toggleRuler(): void { this.dispatch({ kind: 'measuring', measuring: !this.state.measuring }); }

  private measure(at: Point): void {
    const ruler = Ruler.place(this.state.map, at, this.state.ruler);
    if (ruler) this.dispatch({ kind: 'ruler', ruler });
    this.notice(ruler ? '' : 'There is no map point near: tap a corner or an edge, or look at it a little longer.', 'cube');
  }

  toggleRecording(): void {
    if (this.recorder) return void this.stopRecording('');
    this.recorder = new Recorder({
      userAgent: navigator.userAgent, width: this.video.videoWidth, height: this.video.videoHeight, focusHeld: this.camera?.focusHeld ?? false,
      fov: this.state.choices.fov, began: new Date().toISOString(),
    });
    this.dispatch({ kind: 'recording', images: 0 });
    // iOS asks the user for permission to use the motion sensors.
    const asks = DeviceMotionEvent as unknown as { requestPermission?(): Promise<string> } | undefined;
    void asks?.requestPermission?.().catch(() => {});
  }

  save(): void {
    const { engine } = this;
    if (engine instanceof RemoteEngine) return this.offer([], 'The computer that serves this page writes the map when the session ends, if it was started with --out.');
    if (!engine) return this.offer([], 'There is nothing to save yet.');
    const of = (what: 'map' | 'trajectory' | 'cloud', type: string) => async () => new Blob([await engine.ask(what)], { type });
    this.offer([
      { name: 'map.alidade', what: 'Map: alidade view, alidade run --load', bytes: of('map', 'application/octet-stream') },
      { name: 'trajectory.txt', what: 'Trajectory of the camera (TUM format)', bytes: of('trajectory', 'text/plain') },
      { name: 'landmarks.ply', what: 'Map points (PLY): MeshLab, CloudCompare', bytes: of('cloud', 'application/octet-stream') },
    ], this.state.shown?.inertial?.metric ? 'Lengths are meters. Record saves the images.'
      : 'Lengths are in map units, because one camera does not measure meters. Record saves the images.');
  }

  // The page is visible again.
  resume(): void {
    if (this.state.phase !== 'running') return;
    void this.wake.hold();
    if (!this.file) this.camera?.resume();
  }

  // Creates a new engine and an empty state for images of this size.
  private async begin(width: number, height: number): Promise<void> {
    const { choices, remote } = this.state;
    this.engine?.close();
    this.dispatch({ kind: 'begin', remote, fov: choices.fov });
    const engine = this.engine = remote ? new RemoteEngine(this.hooks()) : this.prepared ?? this.localEngine();
    if (!remote) this.prepared = null;
    const classes = remote ? [] : detectorClasses(choices);
    await engine.begin({ ...workingSize(width, height), fov: choices.fov, settings: coreSettings(choices), classes });
    if (classes.length > 0) this.detector.connect(engine as LocalEngine);
  }

  private hooks(): Hooks { return engineHooks(this.dispatch, (why) => this.end(why)); }

  private localEngine(): LocalEngine { return new LocalEngine(this.hooks(), this.state.info?.threads ?? false); }

  // An image of the camera.
  private take(time: number, at: number): void {
    if (this.state.phase !== 'running' || !this.camera) return;
    const { motion } = this;
    motion?.image(time, at);
    if (motion && motion.state !== this.state.motion) this.dispatch({ kind: 'motion', motion: motion.state });
    if (this.recorder) {
      this.recorder.add(this.video, time);
      this.dispatch({ kind: 'recording', images: this.recorder.pictures });
      if (this.recorder.full) void this.stopRecording('The recording is as large as a page can hold: it has been ended.');
    }
    if (this.engine?.free) this.engine.push(this.camera.image(), time, this.camera.turned(), motion?.take() ?? new Float64Array(), this.state.ruler?.landmarks ?? []);
  }

  private async stopRecording(why: string): Promise<void> {
    const done = this.recorder;
    this.recorder = null;
    this.dispatch({ kind: 'recording', images: null });
    if (why) this.notice(why, 'record');
    if (!done) return;
    try {
      const { fov } = this.state.choices;
      download(await done.finish(fov === null ? '' : cameraYaml(this.video.videoWidth, this.video.videoHeight, fov)), `${done.name}.zip`);
    } catch (error) {
      this.notice(`The recording could not be kept: ${(error as Error).message}.`, 'record');
    }
  }

  private offer(offers: Parameters<typeof showOffers>[0], note: string): void {
    showOffers(offers, note, (text) => this.notice(text, 'save'));
  }

  private closeCamera(): void {
    this.camera?.close();
    this.camera = null;
    this.motion?.close();
    this.motion = null;
    this.wake.release();
  }

  private closeFile(): void {
    this.file?.close();
    this.file = null;
    this.dispatch({ kind: 'progress', progress: null });
  }

  private notice(text: string, about: string): void { this.dispatch({ kind: 'notice', about, text }); }
}
