// node write_mcap.mjs BAG OUT.mcap none|lz4|zstd|unchunked [ros1]: converts the messages of an uncompressed ROS 1 bag
// to MCAP with @mcap/core, as ROS 2 messages with Foxglove's serializers, or unchanged with `ros1`.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const require = createRequire(pathToFileURL(path.join(process.cwd(), "package.json")));
const { McapWriter } = require("@mcap/core");
const { FileHandleWritable } = require("@mcap/nodejs");
const { ros1, ros2humble } = require("@foxglove/rosmsg-msgs-common");
const { MessageReader } = require("@foxglove/rosmsg-serialization");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");
const zstd = require("@foxglove/wasm-zstd");
const lz4js = require("lz4js");

const [source, out, packing, generation] = process.argv.slice(2);
const asRos1 = generation === "ros1";

// Records of a bag: fields and data. Descends into uncompressed chunks.
function* records(bytes) {
  let at = 13;
  while (at < bytes.length) {
    const headerSize = bytes.readUInt32LE(at);
    const header = bytes.subarray(at + 4, at + 4 + headerSize);
    const fields = fieldsOf(header);
    const size = bytes.readUInt32LE(at + 4 + headerSize);
    const dataAt = at + 8 + headerSize;
    const op = fields.op[0];
    yield { op, fields, data: bytes.subarray(dataAt, dataAt + size) };
    at = op === 5 ? dataAt : dataAt + size;
  }
}

function fieldsOf(header) {
  const fields = {};
  for (let at = 0; at < header.length; ) {
    const size = header.readUInt32LE(at);
    const field = header.subarray(at + 4, at + 4 + size);
    const equals = field.indexOf(61);
    fields[field.subarray(0, equals).toString()] = field.subarray(equals + 1);
    at += 4 + size;
  }
  return fields;
}

// All definitions that a message needs, starting with its own.
function closure(all, name) {
  const list = [all[name]];
  const names = new Set([name]);
  for (let i = 0; i < list.length; i++) {
    for (const field of list[i].definitions) {
      if (!field.isComplex || names.has(field.type)) continue;
      names.add(field.type);
      list.push(all[field.type]);
    }
  }
  return list;
}

function asRos2(message) {
  if (message.header) {
    const { sec, nsec } = message.header.stamp;
    message.header = { stamp: { sec, nsec, nanosec: nsec }, frame_id: message.header.frame_id };
  }
  if (message.K) {
    Object.assign(message, { d: message.D, k: message.K, r: message.R, p: message.P });
  }
  return message;
}

await zstd.isLoaded;
const handle = await fs.promises.open(out, "w");
const writer = new McapWriter({
  writable: new FileHandleWritable(handle),
  useChunks: packing !== "unchunked",
  chunkSize: 200000,
  compressChunk: {
    zstd: (data) => ({ compression: "zstd", compressedData: zstd.compress(data) }),
    lz4: (data) => ({ compression: "lz4", compressedData: Buffer.from(lz4js.compress(data)) }),
  }[packing],
});
await writer.start({ profile: asRos1 ? "ros1" : "ros2", library: "make_samples" });
const topics = new Map();
const readers = new Map();
for (const { op, fields, data } of records(fs.readFileSync(source))) {
  if (op === 7) {
    const id = fields.conn.readUInt32LE();
    const about = fieldsOf(data);
    const type = about.type.toString();
    if (topics.has(id)) continue;
    const name2 = type.replace("/", "/msg/");
    const schemaId = await writer.registerSchema({
      name: asRos1 ? type : name2,
      encoding: asRos1 ? "ros1msg" : "ros2msg",
      data: about.message_definition,
    });
    const channelId = await writer.registerChannel({
      schemaId,
      topic: fields.topic.toString(),
      messageEncoding: asRos1 ? "ros1" : "cdr",
      metadata: new Map(),
    });
    topics.set(id, channelId);
    readers.set(id, {
      reader: new MessageReader(closure(ros1, type)),
      writer: new MessageWriter(closure(ros2humble, type)),
    });
  } else if (op === 2) {
    const id = fields.conn.readUInt32LE();
    const time = BigInt(fields.time.readUInt32LE(0)) * 1000000000n + BigInt(fields.time.readUInt32LE(4));
    const { reader, writer: serialiser } = readers.get(id);
    await writer.addMessage({
      channelId: topics.get(id),
      sequence: 0,
      logTime: time,
      publishTime: time,
      data: asRos1 ? data : serialiser.writeMessage(asRos2(reader.readMessage(data))),
    });
  }
}
await writer.end();
await handle.close();
