// JavaScript of the interactive point cloud (turnable.h): WebGL 1, without libraries or downloads.
#pragma once

namespace alidade {

// The script's world has the axes right, forward, up, and is a cube of edge 1 centered at the
// origin. The camera looks at `at` from distance `far`; `turn` and `tilt` in radians, 0: forward,
// level.
inline constexpr char kTurnableScript[] = R"script(
(() => {
  'use strict';
  const box = document.getElementById('turn'), canvas = box.querySelector('canvas');
  const gl = canvas.getContext('webgl', {antialias: true});
  if (!gl) return;
  const source = document.getElementById('turn-points'), count = +source.dataset.points;
  const bytes = Uint8Array.from(atob(source.textContent), (c) => c.charCodeAt(0));
  const stretches = source.dataset.path.split(' ').filter(Boolean).map(Number);
  const poses = stretches.reduce((a, b) => a + b, 0), colored = source.dataset.colored === '1';
  const shader = (type, text) => {
    const made = gl.createShader(type);
    gl.shaderSource(made, text);
    gl.compileShader(made);
    return made;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `attribute vec3 p; attribute vec3 c;
    uniform mat4 view; uniform float size, least; varying vec3 color;
    void main() { color = c; gl_Position = view * vec4(p - 0.5, 1.0);
      gl_PointSize = clamp(size / gl_Position.w, least, 2.0 * least); }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER,
    `precision mediump float; varying vec3 color; void main() { gl_FragColor = vec4(color, 1.0); }`));
  gl.bindAttribLocation(program, 0, 'p');
  gl.bindAttribLocation(program, 1, 'c');
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return;
  gl.useProgram(program);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.STATIC_DRAW);
  gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 6, 0);
  gl.enableVertexAttribArray(0);
  if (colored) gl.vertexAttribPointer(1, 3, gl.UNSIGNED_BYTE, true, 3, 6 * (count + poses));
  gl.enable(gl.DEPTH_TEST);
  const uniform = (name) => gl.getUniformLocation(program, name);
  const at_view = uniform('view'), at_size = uniform('size'), at_least = uniform('least');
  box.classList.add('on');

  const VIEWS = {behind: {turn: -0.3, tilt: 0.45}, above: {turn: 0, tilt: 1.57}, side: {turn: -1.57, tilt: 0.1}};
  const LENS = 1.6;  // of the narrower side: 64 degrees
  const home = (() => {  // the middle of the points; nine tenths of them and the path are in sight
    const all = new Uint16Array(bytes.buffer, 0, 3 * (count + poses)), step = 1 + Math.floor(count / 2000);
    const some = [];
    for (let i = 0; i < count; i += step) some.push([0, 1, 2].map((k) => all[3 * i + k] / 65535 - 0.5));
    const rank = (values, share) => values.sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];
    const at = [0, 1, 2].map((k) => (rank(some.map((p) => p[k]), 0.1) + rank(some.map((p) => p[k]), 0.9)) / 2);
    for (let i = count; i < count + poses; ++i) some.push([0, 1, 2].map((k) => all[3 * i + k] / 65535 - 0.5));
    const radii = some.map((p) => Math.hypot(p[0] - at[0], p[1] - at[1], p[2] - at[2]));
    const radius = Math.max(rank(radii.slice(0, -poses), 0.9), ...radii.slice(-poses).filter((_, i) => i % (1 + Math.floor(poses / 1000)) === 0));
    return {at, far: Math.min(3, Math.max(0.1, 2 * radius))};
  })();
  const eye = {turn: 0, tilt: 0, ...home};
  let asked = 0;
  const ask = () => { if (!asked) asked = requestAnimationFrame(draw); };
  const axes = () => {  // right, up, and towards the eye
    const [s, c, u, v] = [Math.sin(eye.turn), Math.cos(eye.turn), Math.sin(eye.tilt), Math.cos(eye.tilt)];
    return [[c, -s, 0], [s * u, c * u, v], [-s * v, -c * v, u]];
  };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const ink = (name) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
  };
  const bar = document.getElementById('turn-scale'), extent = +source.dataset.extent;
  const scale = () => {  // a length of 1, 2 or 5 times a power of ten, at the distance of the middle
    const pixels = LENS * Math.min(canvas.clientWidth, canvas.clientHeight) / 2 / eye.far / extent;
    const wanted = canvas.clientWidth / 6 / pixels, power = 10 ** Math.floor(Math.log10(wanted));
    const length = power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
    bar.style.width = `${(length * pixels).toFixed(1)}px`;
    const unit = length === 1 ? source.dataset.unit.replace(/s$/, '') : source.dataset.unit;
    bar.textContent = `${+length.toPrecision(3)} ${unit}`;
  };
  function draw() {
    asked = 0;
    const dots = window.devicePixelRatio || 1;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * dots)));
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.viewport(0, 0, w, h);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [x, y, z] = axes(), least = Math.min(w, h), fx = LENS * least / w, fy = LENS * least / h;
    const near = 0.01, end = 20, a = (end + near) / (near - end), b = 2 * end * near / (near - end);
    const [tx, ty, tz] = [-dot(x, eye.at), -dot(y, eye.at), -dot(z, eye.at) - eye.far];
    gl.uniformMatrix4fv(at_view, false, [0, 1, 2].flatMap((i) => [fx * x[i], fy * y[i], a * z[i], -z[i]])
      .concat([fx * tx, fy * ty, a * tz + b, -tz]));
    gl.uniform1f(at_size, 0.0025 * least * LENS);
    gl.uniform1f(at_least, (colored ? 1.2 : 2) * dots);
    if (colored) gl.enableVertexAttribArray(1);
    else gl.vertexAttrib3f(1, ...ink('--dot'));
    gl.drawArrays(gl.POINTS, 0, count);
    gl.disableVertexAttribArray(1);
    gl.vertexAttrib3f(1, ...ink('--path'));
    gl.uniform1f(at_least, 3 * dots);
    gl.drawArrays(gl.POINTS, count, poses);
    let first = count;
    for (const length of stretches) {
      gl.drawArrays(gl.LINE_STRIP, first, length);
      first += length;
    }
    scale();
    box.dataset.turn = eye.turn.toFixed(3);
  }
  const show = (name) => {
    Object.assign(eye, VIEWS[name], home);
    ask();
  };
  const turn = (x, y) => {
    eye.turn += x;
    eye.tilt = Math.min(1.57, Math.max(-1.57, eye.tilt + y));
    ask();
  };
  const nearer = (factor) => {
    eye.far = Math.min(6, Math.max(0.05, eye.far / factor));
    ask();
  };
  const move = (dx, dy) => {  // pixels
    const scale = eye.far / (LENS * Math.min(canvas.clientWidth, canvas.clientHeight) / 2), [x, y] = axes();
    eye.at = eye.at.map((v, i) => v - scale * (dx * x[i] - dy * y[i]));
    ask();
  };
  const down = new Map();
  canvas.addEventListener('pointerdown', (e) => {
    down.set(e.pointerId, [e.clientX, e.clientY]);
    canvas.setPointerCapture(e.pointerId);
  });
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'])
    canvas.addEventListener(name, (e) => down.delete(e.pointerId));
  canvas.addEventListener('pointermove', (e) => {
    const before = down.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before[0], dy = e.clientY - before[1];
    const other = [...down].find(([id]) => id !== e.pointerId);
    down.set(e.pointerId, [e.clientX, e.clientY]);
    if (other) {
      const from = (p) => Math.hypot(p[0] - other[1][0], p[1] - other[1][1]) || 1;
      nearer(from([e.clientX, e.clientY]) / from(before));
      move(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons === 2) {
      move(dx, dy);
    } else {
      turn(dx * 0.008, dy * 0.008);
    }
  });
  canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  canvas.addEventListener('wheel', (e) => {  // the page scrolls until the canvas was clicked
    if (document.activeElement !== canvas) return;
    e.preventDefault();
    nearer(Math.exp(-e.deltaY * 0.0015));
  }, {passive: false});
  const KEYS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
  canvas.addEventListener('keydown', (e) => {
    const way = KEYS[e.key];
    if (way && e.shiftKey) move(-20 * way[0], -20 * way[1]);
    else if (way) turn(0.1 * way[0], 0.1 * way[1]);
    else if (e.key === '+' || e.key === '=') nearer(1.15);
    else if (e.key === '-') nearer(1 / 1.15);
    else return;
    e.preventDefault();
  });
  for (const button of box.querySelectorAll('button')) button.addEventListener('click', () => show(button.dataset.view));
  canvas.addEventListener('webglcontextlost', () => box.classList.remove('on'));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', ask);
  new ResizeObserver(ask).observe(canvas);
  show('behind');
})();
)script";

}  // namespace alidade
