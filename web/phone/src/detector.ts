// Excludes people: runs the user's detector network in a Worker of its own.
import { byId, write } from '../../shared/src/dom.ts';
import { forgetFile, keepFile, keptFile, MOST_BYTES } from './detector_file.ts';
import type { LocalEngine } from './engine.ts';
import type { DetectorNews, ToDetector } from './protocol.ts';
import { keep } from './settings.ts';
import type { Choices } from './settings.ts';

export class DetectorHost {
  looks = 0; // number of processed images
  things = 0; // detections in the last one
  milliseconds = 0; // processing time of the last one
  private worker: Worker | null = null;
  private opened: Promise<readonly string[]> | null = null; // class names of the network in `worker`

  // `stopped` is called with a text for users when the detector fails.
  constructor(private readonly choices: Choices, private readonly stopped: (text: string) => void) {
    const input = byId('set-detector') as HTMLInputElement;
    input.addEventListener('change', () => {
      const chosen = input.files?.[0];
      input.value = '';
      if (chosen) void this.add(chosen);
    });
    byId('remove-detector').addEventListener('click', () => void this.remove());
    this.tell();
  }

  // Connects the detector to an engine that began with the classes of choices.detector. Does not block; the file is
  // loaded meanwhile.
  connect(engine: LocalEngine): void {
    const { detector } = this.choices;
    if (!detector) return;
    void (async () => {
      const model = this.opened ? null : await keptFile();
      if (!this.opened && !model) throw new Error('the file is no longer there: add it again');
      await (this.opened ?? this.open(model!));
      const { port1, port2 } = new MessageChannel();
      engine.connect(port1);
      this.send({ kind: 'connect', port: port2 }, [port2]);
    })().catch((error: Error) => this.stopped(`The detector ${detector.name} cannot run: ${error.message}. Only objects that are seen moving are left out.`));
  }

  // Accepts the file once it was loaded and run successfully.
  private async add(file: File): Promise<void> {
    this.tell(`Trying ${file.name} …`);
    try {
      if (file.size > MOST_BYTES) throw new Error('it is larger than 200 MB: which is too large for a phone');
      const model = await file.arrayBuffer();
      const classes = await this.open(model);
      await keepFile(model);
      this.choices.detector = { name: file.name, classes };
      this.choices.moving = true;
      (byId('set-moving') as HTMLInputElement).checked = true;
      keep(this.choices);
      this.tell();
    } catch (error) {
      this.tell(`${file.name} was not taken: ${(error as Error).message}.`);
    }
  }

  private async remove(): Promise<void> {
    this.choices.detector = null;
    keep(this.choices);
    this.end();
    this.tell();
    await forgetFile();
  }

  private open(model: ArrayBuffer): Promise<readonly string[]> {
    this.end();
    const worker = this.worker = new Worker(new URL('detector_worker.js', document.baseURI), { type: 'module' });
    this.opened = new Promise((resolve, reject) => {
      worker.onerror = (event) => reject(new Error(event.message || 'its Worker could not be started'));
      worker.onmessage = ({ data }: MessageEvent<DetectorNews>) => {
        if (data.kind === 'opened') resolve(data.classes);
        else if (data.kind === 'refused') reject(new Error(data.error));
        else if (data.kind === 'looked') {
          ++this.looks;
          ({ things: this.things, milliseconds: this.milliseconds } = data);
        } else {
          this.end();
          this.stopped(`The detector has stopped: ${data.error}. Only objects that are seen moving are left out.`);
        }
      };
    });
    this.opened.catch(() => this.end());
    this.send({ kind: 'open', base: new URL('core/detector/', document.baseURI).href, model });
    return this.opened;
  }

  private end(): void {
    this.worker?.terminate();
    this.worker = this.opened = null;
  }

  private send(message: ToDetector, transfer: Transferable[] = []): void { this.worker?.postMessage(message, transfer); }

  private tell(problem = ''): void {
    const { detector } = this.choices;
    byId('remove-detector').hidden = detector === null;
    const people = detector?.classes.includes('person');
    write(byId('detector-note'), problem || (detector ? `${detector.name}: ${detector.classes.length} kinds of things${people ? ', people among them' : ''}` : 'none'));
  }
}
