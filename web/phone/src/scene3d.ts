// The scene of the map, with three.js. A bundle of its own (scene3d.js): most of the script, loaded once the page is shown.
export { Scene } from '@alidade/scene';
