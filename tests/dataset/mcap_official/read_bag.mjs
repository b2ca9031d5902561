// SPDX-License-Identifier: BSD-3-Clause
// usage: node read_bag.mjs DATA.bag   (made by write_recording_sample: 20 scans of 5000 points)
// Reads the bag with an independent reader, decodes every message from the definitions in the file,
// and compares it with the values of the sample.
import { Bag } from "@foxglove/rosbag";
import { FileReader } from "@foxglove/rosbag/node.js";
import decompressLZ4 from "@foxglove/wasm-lz4";
import assert from "node:assert/strict";

const SCANS = 20;
const POINTS = 5000;
const START_NS = 100_000_000_000n;

const toNs = (stamp) => BigInt(stamp.sec) * 1_000_000_000n + BigInt(stamp.nsec);

const checks = {
  "/mid360/points": (cloud, scan) => {
    assert.equal(toNs(cloud.header.stamp), START_NS + BigInt(scan) * 100_000_000n + 7n);
    assert.equal(cloud.height * cloud.width, POINTS);
    assert.equal(cloud.data.byteLength, 24 * POINTS);
    const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength);
    for (let i = 0; i < POINTS; i++) {
      // computed in float32: angles up to 50 rad rounded to 4e-6
      assert.ok(Math.abs(view.getFloat32(24 * i, true) - 5 * Math.cos(0.01 * (i + scan))) < 5e-5);
      assert.equal(view.getUint32(24 * i + 16, true), Math.floor((99_999_999 * i) / POINTS));
      assert.equal(view.getUint16(24 * i + 20, true), i % 4);
    }
  },
  "/mid360/imu": (imu, i) => {
    assert.equal(toNs(imu.header.stamp), START_NS + BigInt(i) * 5_000_000n);
    assert.equal(imu.angular_velocity.y, 1 / 3);
    assert.equal(imu.linear_acceleration.z, 9.80665);
  },
  "/truth/odometry": (odometry, i) => {
    assert.equal(odometry.child_frame_id, "base_link");
    assert.equal(odometry.pose.pose.position.y, 2 * (0.005 * i));
  },
  "/lidarena/description": (text) => {
    assert.equal(JSON.parse(JSON.parse(text.data).rig).lidars[0].id, "mid360");
  },
};

await decompressLZ4.isLoaded;
const bag = new Bag(new FileReader(process.argv[2]), { decompress: { lz4: decompressLZ4 } });
await bag.open();
const counts = {};
for await (const result of bag.messageIterator()) {
  const index = counts[result.topic] ?? 0;
  counts[result.topic] = index + 1;
  checks[result.topic]?.(result.message, index);
}
assert.equal(counts["/mid360/points"], SCANS);
assert.equal(counts["/lidarena/description"], 1);
assert.equal(counts["/tf_static"], 1);
assert.ok(counts["/mid360/imu"] > 20 * SCANS);
assert.equal(counts["/tf"], counts["/mid360/imu"]);
console.log(JSON.stringify({ counts, chunks: bag.chunkInfos.length }));
