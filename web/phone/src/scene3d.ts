// The scene of the map, with three.js. A bundle of its own (scene3d.js, four fifths of all script), which the page loads
// once it is shown.
export { NoWebGL, Scene } from '@alidade/scene';
