// A pinhole camera with radial and tangential distortion (Brown): k1 k2 p1 p2 k3; pixels with 0, 0 at the center of the
// top-left one.
import type { Camera } from '@alidade/scene';

export type Point = readonly [number, number];
export type Ray = readonly [number, number, number];

// Projects a point of the camera's frame (x right, y down, z forward); null: behind the camera.
export function project(camera: Camera, [x, y, z]: Ray): Point | null {
  if (z <= 0) return null;
  const [u, v] = distort(camera, x / z, y / z);
  return [camera.fx * u + camera.cx, camera.fy * v + camera.cy];
}

// Ray of a pixel, z = 1: fixed-point iteration of u = observed - distortion(u), 20 steps.
export function unproject(camera: Camera, [px, py]: Point): Ray {
  const [a, b] = [(px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy];
  let [u, v] = [a, b];
  for (let i = 0; i < 20; ++i) {
    const [du, dv] = distort(camera, u, v);
    u += a - du;
    v += b - dv;
  }
  return [u, v, 1];
}

function distort({ distortion }: Camera, u: number, v: number): Point {
  const [k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0] = distortion;
  const r2 = u * u + v * v;
  const radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return [u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u), v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v];
}
