export * from './messages.ts';
export { decode, DecodeError, VERSION } from './decode.ts';
export { State } from './state.ts';
export * as poses from './pose.ts';
export { History, HISTORY } from './history.ts';
export { StreamFileReader } from './stream_file.ts';
export { LAYERS, NoWebGL, Scene } from './scene.ts';
export type { Colours, LayerName } from './scene.ts';
export type { ViewMode } from './view.ts';
