// The Worker of the detector: runs the user's network over the pictures that the core's Worker hands it, one at a time.
// Nobody waits for it.
import { DetectorModule } from './detector_module.ts';
import type { DetectorNews, FromDetector, Look, ToDetector } from './protocol.ts';

const REST = 0.5; // of the time that a picture took: tracking has the processor meanwhile (dynamics.detector_rest)

// As much of onnxruntime-web as is used.
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

// What cannot work fails here: the network is run once, on a grey picture.
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
