// SPDX-License-Identifier: BSD-3-Clause
// usage: node read_all.mjs DATA.mcap   (made by write_mcap_sample: 20 scans of 5000 points)
// Reads the file with the official reader, indexed and streamed, decodes every message from the
// definitions in the file, and compares it with the values of the sample.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import assert from "node:assert/strict";
import { open, readFile } from "node:fs/promises";
import { decompress } from "fzstd";

const SCANS = 20;
const POINTS = 5000;
const START_NS = 100_000_000_000n;

const decompressHandlers = { zstd: (buffer, size) => decompress(buffer, new Uint8Array(Number(size))) };

/** Decodes messages of a channel by the schema in the file. */
class Decoder {
  readers = new Map();
  decode(channel, schema, data) {
    assert.equal(channel.messageEncoding, "cdr");
    assert.equal(schema.encoding, "ros2msg");
    let reader = this.readers.get(schema.id);
    if (!reader) {
      const text = new TextDecoder().decode(schema.data);
      reader = new MessageReader(parse(text, { ros2: true }));
      this.readers.set(schema.id, reader);
    }
    return reader.readMessage(data);
  }
}

/** Counts and checks of messages, the same for both ways of reading. */
class Tally {
  counts = {};
  points = 0;
  decoder = new Decoder();
  lastMeasurement = 0n;

  add(message, channel, schema) {
    const topic = channel.topic;
    const index = this.counts[topic] ?? 0;
    assert.equal(message.sequence, index, `${topic}: sequence`);
    this.counts[topic] = index + 1;
    const value = this.decoder.decode(channel, schema, message.data);
    if (topic === "/mid360/points" || topic === "/mid360/imu") {
      assert.ok(message.logTime >= this.lastMeasurement, "measurements are in log time order");
      this.lastMeasurement = message.logTime;
    }
    checks[topic]?.(value, index, this);
  }
}

const toNs = (stamp) => BigInt(stamp.sec) * 1_000_000_000n + BigInt(stamp.nanosec ?? stamp.nsec);
const near = (a, b, tolerance) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

const FLOAT32 = 7, UINT32 = 6, UINT16 = 4, UINT8 = 2;
const FIELDS = [
  ["x", 0, FLOAT32], ["y", 4, FLOAT32], ["z", 8, FLOAT32], ["intensity", 12, FLOAT32],
  ["t", 16, UINT32], ["ring", 20, UINT16], ["echo", 22, UINT8],
];

const checks = {
  "/mid360/points": (cloud, scan, tally) => {
    assert.equal(toNs(cloud.header.stamp), START_NS + BigInt(scan) * 100_000_000n + 7n);
    assert.equal(cloud.header.frame_id, "mid360_lidar");
    assert.equal(cloud.height * cloud.width, POINTS);
    assert.equal(cloud.point_step, 24);
    assert.equal(cloud.row_step, 24 * POINTS);
    assert.equal(cloud.data.byteLength, 24 * POINTS);
    assert.equal(cloud.is_bigendian, false);
    assert.equal(cloud.is_dense, true);
    assert.deepEqual(cloud.fields.map((f) => [f.name, f.offset, f.datatype]), FIELDS);
    const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength);
    for (let i = 0; i < POINTS; i++) {
      const at = 24 * i;
      const angle = 0.01 * (i + scan);
      // computed in float32: angles up to 50 rad rounded to 4e-6, heights up to 500 m to 3e-5
      near(view.getFloat32(at, true), 5 * Math.cos(angle), 5e-5);
      near(view.getFloat32(at + 4, true), 5 * Math.sin(angle), 5e-5);
      near(view.getFloat32(at + 8, true), 0.1 * i, 5e-5);
      assert.equal(view.getFloat32(at + 12, true), i % 256);
      assert.equal(view.getUint32(at + 16, true), Math.floor((99_999_999 * i) / POINTS));
      assert.equal(view.getUint16(at + 20, true), i % 4);
      assert.equal(view.getUint8(at + 22), i % 3);
      assert.equal(view.getUint8(at + 23), 0);
    }
    tally.points += POINTS;
  },
  "/mid360/imu": (imu, i) => {
    assert.equal(toNs(imu.header.stamp), START_NS + BigInt(i) * 5_000_000n);
    assert.equal(imu.header.frame_id, "mid360_imu");
    near(imu.angular_velocity.x, Math.sin(0.005 * i), 1e-15);
    assert.equal(imu.angular_velocity.y, 1 / 3);
    assert.equal(imu.linear_acceleration.z, 9.80665);
    assert.equal(imu.orientation_covariance[0], -1);
    assert.equal(imu.linear_acceleration_covariance.length, 9);
  },
  "/truth/odometry": (odometry, i) => {
    assert.equal(toNs(odometry.header.stamp), START_NS + BigInt(i) * 5_000_000n);
    assert.equal(odometry.header.frame_id, "world");
    assert.equal(odometry.child_frame_id, "base_link");
    assert.equal(odometry.pose.pose.position.y, 2 * (0.005 * i));
    near(odometry.pose.pose.orientation.z, Math.sin(0.05 * 0.005 * i), 1e-14);
    assert.equal(odometry.twist.covariance.length, 36);
  },
  "/tf": (message, i) => {
    assert.equal(message.transforms.length, 1);
    const [transform] = message.transforms;
    assert.equal(transform.header.frame_id, "world");
    assert.equal(transform.child_frame_id, "base_link");
    assert.equal(transform.transform.translation.z, 1.5);
    near(transform.transform.rotation.w, Math.cos(0.05 * 0.005 * i), 1e-14);
  },
  "/tf_static": (message) => {
    assert.deepEqual(message.transforms.map((t) => t.child_frame_id), ["mid360_lidar", "mid360_imu"]);
    near(message.transforms[0].transform.translation.x, 0.1, 1e-15);
    near(Math.abs(message.transforms[0].transform.rotation.x), 0.5, 1e-15);
  },
};

/** Reads by the index, in log time order. */
async function readIndexed(path) {
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(buffer, 0, Number(length), Number(offset));
      assert.equal(bytesRead, Number(length));
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const tally = new Tally();
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    tally.add(message, channel, reader.schemasById.get(channel.schemaId));
  }
  const metadata = [];
  for await (const record of reader.readMetadata()) metadata.push(record);
  await file.close();
  return { tally, reader, metadata };
}

/** From front to back, verifying the checksums of the chunks. */
async function readStreamed(path) {
  const reader = new McapStreamReader({
    decompressHandlers,
    includeChunks: true,
    validateCrcs: true,
  });
  reader.append(await readFile(path));
  const tally = new Tally();
  const schemas = new Map();
  const channels = new Map();
  const kinds = {};
  for (let record; (record = reader.nextRecord()); ) {
    kinds[record.type] = (kinds[record.type] ?? 0) + 1;
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") {
      const channel = channels.get(record.channelId);
      tally.add(record, channel, schemas.get(channel.schemaId));
    }
  }
  assert.ok(reader.done(), "the stream ends where it should");
  assert.equal(reader.bytesRemaining(), 0);
  return { tally, kinds };
}

const path = process.argv[2];
const indexed = await readIndexed(path);
const streamed = await readStreamed(path);
const { reader, metadata } = indexed;

assert.equal(reader.header.profile, "ros2");
const total = Object.values(indexed.tally.counts).reduce((a, b) => a + b, 0);
assert.equal(BigInt(total), reader.statistics.messageCount, "statistics: messages");
for (const [id, channel] of reader.channelsById) {
  const count = reader.statistics.channelMessageCounts.get(id);
  assert.equal(BigInt(indexed.tally.counts[channel.topic] ?? 0), count, `statistics: ${channel.topic}`);
}
assert.deepEqual(streamed.tally.counts, indexed.tally.counts);
assert.equal(indexed.tally.counts["/mid360/points"], SCANS);
assert.equal(indexed.tally.points, SCANS * POINTS);
assert.equal(indexed.tally.counts["/tf_static"], 1);
assert.ok(indexed.tally.counts["/mid360/imu"] > 20 * SCANS);
assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
assert.equal(streamed.kinds.Chunk, reader.chunkIndexes.length);
assert.ok(reader.chunkIndexes.length > 1, "several chunks");
assert.equal(streamed.kinds.DataEnd, 1);
assert.equal(streamed.kinds.Footer, 1);

const byName = Object.fromEntries(metadata.map((record) => [record.name, record.metadata]));
assert.equal(JSON.parse(byName.lidarena.get("rig")).lidars[0].id, "mid360");
assert.equal(JSON.parse(byName.lidarena.get("topics")).imus.mid360, "/mid360/imu");
assert.match(byName.rosbag2.get("serialized_metadata"), /storage_identifier: mcap/);

console.log(JSON.stringify({ counts: indexed.tally.counts, points: indexed.tally.points,
  messages: total, chunks: reader.chunkIndexes.length, records: streamed.kinds }, null, 2));
