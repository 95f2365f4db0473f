// Reads MCAP files with public libraries: @mcap/core for the container, @foxglove/rosmsg for the schemas,
// @foxglove/rosmsg2-serialization for CDR.
import { readFileSync } from 'node:fs';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';
import { McapIndexedReader, McapStreamReader } from '@mcap/core';
import { decompress } from 'fzstd';

// Any: described by the schema in the file.
export interface Told { topic: string; time: bigint; bytes: Uint8Array; message: any }

const decompressHandlers = { zstd: (packed: Uint8Array, size: bigint) => decompress(packed, new Uint8Array(Number(size))) };

// Reads by the index and verifies the checksum of every chunk.
export async function readIndexed(path: string) {
  const bytes = readFileSync(path);
  const reader = await McapIndexedReader.Initialize({
    readable: { size: async () => BigInt(bytes.length), read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)) },
    decompressHandlers,
  });
  const decoders = new Map<number, MessageReader>();
  const told: Told[] = [];
  for await (const { channelId, logTime, data } of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(channelId)!;
    let decoder = decoders.get(channel.schemaId);
    if (!decoder) {
      const schema = reader.schemasById.get(channel.schemaId)!;
      decoder = new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true }));
      decoders.set(channel.schemaId, decoder);
    }
    told.push({ topic: channel.topic, time: logTime, bytes: data.slice(), message: decoder.readMessage(data) });
  }
  return { reader, told, on: (topic: string) => told.filter((each) => each.topic === topic) };
}

// Reads sequentially as far as possible; returns the number of messages and whether the end was complete.
export function readThrough(path: string): { messages: number; complete: boolean } {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(readFileSync(path));
  let messages = 0;
  for (let record; (record = reader.nextRecord());) if (record.type === 'Message') ++messages;
  return { messages, complete: reader.done() };
}

export const seconds = ({ sec, nsec, nanosec }: { sec: number; nsec?: number; nanosec?: number }) => sec + 1e-9 * (nsec ?? nanosec ?? NaN);

type Vector = { x: number; y: number; z: number; w?: number };
// A row of a trajectory: t x y z qx qy qz qw.
export const row = (stamp: { sec: number; nsec?: number }, t: Vector, q: Vector) => [seconds(stamp), t.x, t.y, t.z, q.x, q.y, q.z, q.w!];

// A PointCloud2 as rows x y z and, if colored, red green blue.
export function points(cloud: any): number[][] {
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength);
  const rows: number[][] = [];
  const colored = cloud.fields.some((field: { name: string }) => field.name === 'rgb');
  for (let at = 0; at < cloud.data.byteLength; at += cloud.point_step) {
    const point = [0, 4, 8].map((offset) => view.getFloat32(at + offset, true));
    if (colored) point.push(view.getUint8(at + 14), view.getUint8(at + 13), view.getUint8(at + 12));
    rows.push(point);
  }
  return rows;
}
