// The detector's Worker: runs the user's network on the images it gets from the core's Worker, one at a time. Tracking
// does not wait for it.
import { DetectorModule } from './detector_module.ts';
import type { DetectorNews, FromDetector, Look, ToDetector } from './protocol.ts';

// Share of an image's processing time to pause afterwards, so that tracking gets CPU time (dynamics.detector_rest).
const REST = 0.5;

// The part of onnxruntime-web's interface that is used.
interface Tensor { readonly type: string; readonly dims: readonly number[]; readonly data: Float32Array }
interface Session { readonly inputNames: readonly string[]; readonly outputNames: readonly string[]; run(feeds: Record<string, Tensor>, wanted?: readonly string[]): Promise<Record<string, Tensor>> }
interface Runtime {
  env: { logLevel: string; wasm: { numThreads: number; wasmPaths: string } };
  Tensor: new (type: 'float32', data: Float32Array, dims: readonly number[]) => Tensor;
  InferenceSession: { create(model: Uint8Array, options: object): Promise<Session> };
}

const scope = self as unknown as { postMessage(news: DetectorNews): void; onmessage: ((event: MessageEvent<ToDetector>) => void) | null };

let run: ((input: Float32Array, wanted?: readonly string[]) => Promise<Record<string, Tensor>>) | null = null;
let module: DetectorModule | null = null;
let output = '';
let port: MessagePort | null = null;

// Runs the network once on a gray image, so that unusable networks fail here.
async function open(base: string, model: ArrayBuffer): Promise<void> {
  const bytes = new Uint8Array(model);
  module = await DetectorModule.open(base, bytes);
  const { width, height } = module;
  const { env, Tensor, InferenceSession } = await import(base + 'ort.wasm.min.mjs') as Runtime;
  env.logLevel = 'error';
  env.wasm.numThreads = 1;
  env.wasm.wasmPaths = base;
  const session = await InferenceSession.create(bytes, { executionProviders: ['wasm'], graphOptimizationLevel: 'all' })
    .catch((error: Error) => { throw new Error(`the network cannot be run in a browser: ${error.message}`); });
  run = (input, wanted) => session.run({ [session.inputNames[0]!]: new Tensor('float32', input, [1, 3, height, width]) }, wanted);
  const outputs = await run(module.input());
  const names = session.outputNames.filter((name) => outputs[name]!.type === 'float32');
  const recognised = module.recognise(names.map((name) => outputs[name]!));
  output = names[recognised.output]!;
  scope.postMessage({ kind: 'opened', classes: recognised.classes });
}

async function look({ number, width, height, pixels }: Look): Promise<void> {
  if (!run || !module || !port) return;
  const from = port;
  const begin = performance.now();
  const outputs = await run(module.prepare(new Uint8Array(pixels), width, height), [output]);
  const found = module.read(outputs[output]!, width, height);
  const milliseconds = performance.now() - begin;
  from.postMessage({ kind: 'found', number, found } satisfies FromDetector);
  scope.postMessage({ kind: 'looked', milliseconds, things: found.length / 6 });
  setTimeout(() => from.postMessage({ kind: 'free' } satisfies FromDetector), REST * milliseconds);
}

const words = (error: unknown) => (error instanceof Error ? error.message : String(error));

scope.onmessage = ({ data }) => {
  if (data.kind === 'open') return void open(data.base, data.model).catch((error: unknown) => scope.postMessage({ kind: 'refused', error: words(error) }));
  port?.close();
  port = data.port;
  port.onmessage = (event: MessageEvent<Look>) => void look(event.data).catch((error: unknown) => scope.postMessage({ kind: 'stopped', error: words(error) }));
};
