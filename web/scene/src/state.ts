// State of a viewer: the sum of all messages. Only apply() changes it; clone() is cheap (see pages.ts).
import { Landmarks } from './landmarks.ts';
import type { Culled, DepthCloud, Frame, Hello, KeyFrame, MapChange, Message, Playback, Pose, TrackingState, World } from './messages.ts';
import { NONE } from './messages.ts';
import { Path } from './path.ts';
import { compose, IDENTITY, transform } from './pose.ts';

export class State {
  hello: Hello | null = null;
  frame: Frame | null = null; // the latest frame
  pictured: Frame | null = null; // the latest frame with an image, because not every frame has one
  playback: Playback | null = null;
  mapVersion = 0n;
  // Objects in these two maps are replaced, never modified.
  keyframes = new Map<number, KeyFrame>();
  clouds = new Map<number, DepthCloud>();
  worlds = new Map<number, World>(); // by map; replaced, never modified
  landmarks = new Landmarks();
  path = new Path();
  incomplete = false; // a message referred to an unknown keyframe; only a whole state resolves this

  clone(): State {
    const copy = new State();
    Object.assign(copy, this);
    copy.keyframes = new Map(this.keyframes);
    copy.clouds = new Map(this.clouds);
    copy.landmarks = this.landmarks.clone();
    copy.path = this.path.clone();
    return copy;
  }

  apply(message: Message): void {
    switch (message.kind) {
      case 'hello':
        this.hello = message;
        break;
      case 'frame':
        this.frame = message;
        if (message.picture) this.pictured = message;
        this.path.set([{
          number: message.number, time: message.time, state: message.state, reference: message.reference,
          T_reference_camera: message.T_reference_camera ?? IDENTITY,
        }]);
        break;
      case 'map':
        this.applyMap(message);
        break;
      case 'playback':
        this.playback = message;
        break;
      case 'event':
        break; // stored in the history
    }
  }

  // The latest frame; after joining late it is known from the path only.
  get latest(): { number: number; time: number; state: TrackingState } | null {
    const last = this.path.length > 0 ? this.path.at(this.path.length - 1) : null;
    return !this.frame || (last && last.number > this.frame.number) ? last : this.frame;
  }

  // Pose of the latest frame in the current map, or the predicted pose; null: unknown.
  cameraPose(): Pose | null {
    if (this.path.length === 0) return this.frame?.T_world_camera ?? null;
    const last = this.path.at(this.path.length - 1);
    if (last.state !== 'tracking') return this.frame?.predicted && this.frame.number === last.number ? this.frame.T_world_camera : null;
    const reference = this.keyframes.get(last.reference);
    if (reference) return compose(reference.T_world_camera, reference.scale, last.T_reference_camera);
    return this.frame?.number === last.number ? this.frame.T_world_camera : null;
  }

  // The map of the latest frame; NONE if there is none.
  get activeMap(): number {
    for (let i = this.path.length - 1; i >= 0; --i) {
      const keyframe = this.keyframes.get(this.path.at(i).reference);
      if (keyframe) return keyframe.map;
      if (i < this.path.length - 1000) break;
    }
    let newest: KeyFrame | undefined;
    for (const keyframe of this.keyframes.values()) if (!newest || keyframe.id > newest.id) newest = keyframe;
    return newest?.map ?? NONE;
  }

  // Of lengths in the active map: "m" or "map units"; '' before the first message.
  get unit(): string {
    return this.worlds.get(this.activeMap)?.meters ? 'm' : this.hello?.unit ?? '';
  }

  // World position of a landmark; undefined: unknown id.
  landmarkInWorld(id: number): [number, number, number] | undefined {
    const landmark = this.landmarks.get(id);
    const keyframe = landmark && this.keyframes.get(landmark.keyframe);
    return keyframe && transform(keyframe.T_world_camera, keyframe.scale, ...landmark.p);
  }

  private applyMap(change: MapChange): void {
    this.mapVersion = change.version;
    if (change.whole) {
      this.keyframes = new Map();
      this.clouds = new Map();
      this.worlds = new Map();
      this.landmarks = new Landmarks();
      this.path = new Path();
      this.incomplete = false;
    }
    if (change.worlds) this.worlds = new Map(change.worlds.map((world) => [world.map, world]));
    for (const keyframe of change.keyframes) this.keyframes.set(keyframe.id, keyframe);
    for (const { id, scale, T_world_camera } of change.moves) {
      const keyframe = this.keyframes.get(id);
      if (keyframe) this.keyframes.set(id, { ...keyframe, scale, T_world_camera });
      else this.incomplete = true;
    }
    const { landmarks } = change;
    for (let at = 0; at < landmarks.byteLength; at += 20) {
      const keyframe = landmarks.getUint32(at + 4, true);
      if (!this.keyframes.has(keyframe)) this.incomplete = true;
      this.landmarks.set(landmarks.getUint32(at, true), keyframe,
        landmarks.getFloat32(at + 8, true), landmarks.getFloat32(at + 12, true), landmarks.getFloat32(at + 16, true));
    }
    for (const id of change.removedLandmarks) this.landmarks.remove(id);
    if (change.culled.length > 0) this.cull(change.culled);
    for (const cloud of change.depth) {
      if (cloud.points.length > 0) this.clouds.set(cloud.keyframe, cloud);
      else this.clouds.delete(cloud.keyframe);
    }
    if (change.path.length > 0) this.path.set(change.path);
  }

  // Removes culled keyframes with their semi-dense points, as the program does.
  private cull(culled: readonly Culled[]): void {
    const moves = new Map<number, Culled>();
    for (const one of culled) {
      this.keyframes.delete(one.id);
      this.clouds.delete(one.id);
      moves.set(one.id, one);
    }
    const resolved = resolve(moves);
    this.landmarks.follow(resolved);
    this.path.follow(resolved);
  }
}

// A replacing keyframe may be culled by the same message: chains are composed so that all end at existing keyframes. A
// cycle ends as `none`.
function resolve(moves: ReadonlyMap<number, Culled>): Map<number, Culled> {
  const resolved = new Map<number, Culled>();
  for (const first of moves.values()) {
    const chain: Culled[] = [];
    const seen = new Set<number>();
    let one: Culled | undefined = first;
    while (one && !resolved.has(one.id) && !seen.has(one.id)) {
      chain.push(one);
      seen.add(one.id);
      one = moves.get(one.follows);
    }
    const circle = one !== undefined && seen.has(one.id);
    for (const move of chain.reverse()) {
      const next = resolved.get(move.follows);
      if (circle) resolved.set(move.id, { ...move, follows: NONE });
      else if (!next) resolved.set(move.id, move);
      else {
        resolved.set(move.id, {
          id: move.id, follows: next.follows, scale: next.scale * move.scale,
          T_follows_culled: compose(next.T_follows_culled, next.scale, move.T_follows_culled),
        });
      }
    }
  }
  return resolved;
}
