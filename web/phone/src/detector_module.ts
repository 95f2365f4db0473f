// Wrapper of wasm/detector.cc: prepares the input of a detector network and decodes its outputs.

interface Core {
  HEAPU8: Uint8Array;
  _malloc(bytes: number): number;
  _free(at: number): void;
  UTF8ToString(at: number): string;
  _alidade_detector_error(): number;
  _alidade_detector_open(bytes: number, size: number): number;
  _alidade_detector_input(): number;
  _alidade_detector_width(): number;
  _alidade_detector_height(): number;
  _alidade_detector_output(index: number, shape: number, sides: number): number;
  _alidade_detector_recognise(): number;
  _alidade_detector_names(): number;
  _alidade_detector_prepare(pixels: number, width: number, height: number): number;
  _alidade_detector_read(width: number, height: number, at: number): number;
}

export interface Output { dims: readonly number[]; data: Float32Array }

export class DetectorModule {
  private constructor(private readonly core: Core, readonly width: number, readonly height: number) {}

  // `base`: folder of alidade_detector.mjs. Throws Error with a text for users when the file is not a detector.
  static async open(base: string, model: Uint8Array): Promise<DetectorModule> {
    const { default: create } = await import(base + 'alidade_detector.mjs') as { default: (options: object) => Promise<Core> };
    const core = await create({ locateFile: (name: string) => base + name });
    const at = core._malloc(model.length);
    core.HEAPU8.set(model, at);
    const opened = core._alidade_detector_open(at, model.length);
    core._free(at);
    if (opened !== 0) throw new Error(core.UTF8ToString(core._alidade_detector_error()));
    return new DetectorModule(core, core._alidade_detector_width(), core._alidade_detector_height());
  }

  // A copy of the network's input, 1 x 3 x height x width: of the trial run, later of the last prepare().
  input(): Float32Array {
    return new Float32Array(this.core.HEAPU8.buffer, this.core._alidade_detector_input(), 3 * this.width * this.height).slice();
  }

  // Detects the network's family from all outputs of the trial run. Returns the index of the output for read(), and the
  // class names.
  recognise(outputs: readonly Output[]): { output: number; classes: string[] } {
    outputs.forEach((output, index) => this.give(index, output));
    const output = this.checked(this.core._alidade_detector_recognise());
    return { output, classes: this.core.UTF8ToString(this.core._alidade_detector_names()).split('\n').slice(0, -1) };
  }

  // `pixels`: red green blue alpha.
  prepare(pixels: Uint8Array, width: number, height: number): Float32Array {
    const at = this.core._malloc(pixels.length);
    this.core.HEAPU8.set(pixels, at);
    const done = this.core._alidade_detector_prepare(at, width, height);
    this.core._free(at);
    this.checked(done);
    return this.input();
  }

  // Class, score, x, y, width, height of each detection, in pixels of an image of this size.
  read(output: Output, width: number, height: number): Float32Array {
    this.give(0, output);
    const at = this.core._malloc(4);
    const count = this.core._alidade_detector_read(width, height, at);
    const found = new Uint32Array(this.core.HEAPU8.buffer, at, 1)[0]!;
    this.core._free(at);
    return new Float32Array(this.core.HEAPU8.buffer, found, 6 * this.checked(count)).slice();
  }

  private give(index: number, { dims, data }: Output): void {
    const shape = this.core._malloc(4 * Math.max(1, dims.length));
    new Int32Array(this.core.HEAPU8.buffer, shape, dims.length).set(dims);
    const room = this.core._alidade_detector_output(index, shape, dims.length);
    this.core._free(shape);
    new Float32Array(this.core.HEAPU8.buffer, room, data.length).set(data);
  }

  private checked(result: number): number {
    if (result < 0) throw new Error(this.core.UTF8ToString(this.core._alidade_detector_error()));
    return result;
  }
}
