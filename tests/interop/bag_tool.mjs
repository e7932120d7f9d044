// SPDX-License-Identifier: Apache-2.0
// Bags in the hands of libraries that others wrote; one JSON object on stdout.
//
//   node bag_tool.mjs read-mcap FILE      @mcap/core, both of its readers, CRCs checked
//   node bag_tool.mjs read-db3 FILE...    @foxglove/rosbag2 over sql.js
//   node bag_tool.mjs write-mcap FILE none|zstd
//
// Every message is decoded by the schema that the file carries and encoded again, and must be the
// same bytes: the schema is then what is on the wire.
import { open, readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { decode, encoder } from "./decode.mjs";

const require = createRequire(import.meta.url);
const { McapIndexedReader, McapStreamReader, McapWriter } = require("@mcap/core");
const { Rosbag2, parseQosProfiles } = require("@foxglove/rosbag2");
const initSqlJs = require("@foxglove/sql.js");
const lz4 = (await import("@foxglove/wasm-lz4")).default;
const zstd = (await import("@foxglove/wasm-zstd")).default;
await lz4.isLoaded;
await zstd.isLoaded;

const decompressHandlers = {
  lz4: (buffer, size) => lz4(buffer, Number(size)),
  zstd: (buffer, size) => zstd.decompress(buffer, Number(size)),
};

const print = (value) =>
  console.log(
    JSON.stringify(value, (_, item) => {
      if (typeof item === "bigint") return item.toString();
      if (typeof item === "number" && !Number.isFinite(item)) return String(item);
      return ArrayBuffer.isView(item) ? Array.from(item) : item;
    }),
  );

async function readMcap(path) {
  const bytes = new Uint8Array(await readFile(path));
  const result = { profile: "", topics: {}, messages: [], streamed: 0, chunks: [] };
  const stream = new McapStreamReader({ validateCrcs: true, includeChunks: true, decompressHandlers });
  stream.append(bytes);
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Header") result.profile = record.profile;
    if (record.type === "Chunk") result.chunks.push(record.compression);
    if (record.type === "Message") result.streamed += 1;
  }
  result.complete = stream.done();

  const handle = await open(path, "r");
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, size) => {
      const buffer = new Uint8Array(Number(size));
      await handle.read(buffer, 0, Number(size), Number(offset));
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    result.topics[channel.topic] = {
      type: schema.name,
      encoding: schema.encoding,
      qos: channel.metadata.get("offered_qos_profiles"),
      count: reader.statistics.channelMessageCounts.get(channel.id) ?? 0n,
    };
  }
  result.metadata = {};
  for await (const record of reader.readMetadata()) {
    result.metadata[record.name] = Object.fromEntries(record.metadata);
  }
  result.metadataCount = reader.statistics.metadataCount;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const definition = new TextDecoder().decode(reader.schemasById.get(channel.schemaId).data);
    result.messages.push({
      topic: channel.topic,
      time: message.logTime,
      ...decode(definition, message.data),
    });
  }
  await handle.close();
  print(result);
}

/// What @foxglove/rosbag2 asks of a database, over sql.js.
class Database {
  constructor(path) {
    this.path = path;
  }
  async open() {
    // Given as bytes: the library would fetch it by address, as in a browser.
    const wasmBinary = await readFile(require.resolve("@foxglove/sql.js/dist/sql-wasm.wasm"));
    const SQL = await initSqlJs({ wasmBinary });
    this.db = new SQL.Database(new Uint8Array(await readFile(this.path)));
  }
  async close() {
    this.db.close();
  }
  *rows(sql) {
    const statement = this.db.prepare(sql);
    while (statement.step()) yield statement.get();
    statement.free();
  }
  async readTopics() {
    const sql = "select name, type, serialization_format, offered_qos_profiles from topics";
    return [...this.rows(sql)].map(([name, type, serializationFormat, offeredQosProfiles]) => ({
      name,
      type,
      serializationFormat,
      offeredQosProfiles: parseQosProfiles(offeredQosProfiles),
    }));
  }
  async *readMessages() {
    const topics = new Map((await this.readTopics()).map((topic) => [topic.name, topic]));
    const sql =
      "select topics.name, cast(messages.timestamp / 1000000000 as integer), " +
      "messages.timestamp % 1000000000, messages.data from messages inner join topics " +
      "on messages.topic_id = topics.id order by messages.timestamp";
    for (const [name, sec, nsec, data] of this.rows(sql)) {
      yield { topic: topics.get(name), timestamp: { sec, nsec }, data };
    }
  }
  async timeRange() {
    const [begin, end] = [...this.rows("select min(timestamp), max(timestamp) from messages")][0];
    const time = (ns) => ({ sec: Math.floor(ns / 1e9), nsec: ns % 1e9 });
    return [time(begin), time(end)];
  }
  async messageCounts() {
    const sql =
      "select topics.name, count(*) from messages inner join topics " +
      "on messages.topic_id = topics.id group by topics.name";
    return new Map([...this.rows(sql)]);
  }
}

async function readDb3(paths) {
  const bag = new Rosbag2(paths.map((path) => new Database(path)));
  await bag.open();
  const result = { topics: {}, messages: [] };
  const counts = await bag.messageCounts();
  for (const topic of await bag.readTopics()) {
    result.topics[topic.name] = {
      type: topic.type,
      qos: topic.offeredQosProfiles,
      count: counts.get(topic.name) ?? 0,
    };
  }
  for await (const message of bag.readMessages()) {
    result.messages.push({
      topic: message.topic.name,
      time: message.timestamp,
      value: message.value,
    });
  }
  await bag.close();
  print(result);
}

const kLaserScan = `std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
`;

async function writeMcap(path, compression) {
  const parts = [];
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => {
      parts.push(bytes.slice());
      position += BigInt(bytes.byteLength);
    },
  };
  const compressChunk =
    compression === "zstd"
      ? (data) => ({ compression: "zstd", compressedData: zstd.compress(data) })
      : undefined;
  const writer = new McapWriter({ writable, chunkSize: 4096, compressChunk });
  await writer.start({ profile: "ros2", library: "@mcap/core" });
  const schemaId = await writer.registerSchema({
    name: "sensor_msgs/msg/LaserScan",
    encoding: "ros2msg",
    data: new TextEncoder().encode(kLaserScan),
  });
  const channelId = await writer.registerChannel({
    schemaId,
    topic: "/scan",
    messageEncoding: "cdr",
    metadata: new Map([["offered_qos_profiles", "- history: 3"]]),
  });
  const encode = encoder(kLaserScan);
  for (let i = 0; i < 100; i++) {
    const data = encode({
      header: { stamp: { sec: 100 + i, nanosec: 500 }, frame_id: "laser" },
      angle_min: -1, angle_max: 1, angle_increment: 0.5, time_increment: 0, scan_time: 0,
      range_min: 0.1, range_max: 30, ranges: [1 + i, 2, 3, 4, 5], intensities: [],
    });
    const logTime = BigInt(100 + i) * 1000000000n;
    await writer.addMessage({ channelId, sequence: i, logTime, publishTime: logTime, data });
  }
  await writer.end();
  await writeFile(path, Buffer.concat(parts));
  print({ written: 100 });
}

const [verb, ...args] = process.argv.slice(2);
if (verb === "read-mcap") await readMcap(args[0]);
else if (verb === "read-db3") await readDb3(args);
else if (verb === "write-mcap") await writeMcap(args[0], args[1]);
else throw new Error(`unknown verb ${verb}`);
