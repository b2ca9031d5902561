// SPDX-License-Identifier: BSD-3-Clause
// usage: node read_driver.mjs DATA.mcap   (made by write_recording_sample in the dialect "driver")
// Decodes Livox's CustomMsg from the definition in the file, with the official reader.
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapStreamReader } from "@mcap/core";
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { decompress } from "fzstd";

const SCANS = 20;
const POINTS = 5000;
const START_NS = 100_000_000_000n;

const reader = new McapStreamReader({
  decompressHandlers: { zstd: (buffer, size) => decompress(buffer, new Uint8Array(Number(size))) },
});
reader.append(await readFile(process.argv[2]));
const schemas = new Map();
const channels = new Map();
let scans = 0;
for (let record; (record = reader.nextRecord()); ) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type !== "Message") continue;
  const channel = channels.get(record.channelId);
  if (channel.topic !== "/mid360/livox") continue;
  const schema = schemas.get(channel.schemaId);
  assert.equal(schema.name, "livox_ros_driver2/msg/CustomMsg");
  const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
  const message = new MessageReader(definitions).readMessage(record.data);
  assert.equal(message.timebase, START_NS + BigInt(scans) * 100_000_000n + 7n);
  assert.equal(message.points.length, POINTS);
  message.points.forEach((point, i) => {
    // computed in float32: angles up to 50 rad rounded to 4e-6
    assert.ok(Math.abs(point.x - 5 * Math.cos(0.01 * (i + scans))) < 5e-5);
    assert.equal(point.offset_time, Math.floor((99_999_999 * i) / POINTS));
    assert.deepEqual([point.reflectivity, point.tag, point.line], [i % 256, 0, i % 4]);
  });
  ++scans;
}
assert.equal(scans, SCANS);
console.log(`${scans} messages of livox_ros_driver2/msg/CustomMsg`);
