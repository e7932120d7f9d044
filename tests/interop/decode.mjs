// SPDX-License-Identifier: Apache-2.0
// Messages by the definitions that come with them, in the hands of a library that others wrote.
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");

function sameBytes(a, b) {
  return a.byteLength === b.byteLength && a.every((byte, i) => byte === b[i]);
}

/// Decodes by the definition, and checks that encoding gives the bytes again.
export function decode(definition, data) {
  const types = parse(definition, { ros2: true });
  const value = new MessageReader(types).readMessage(data);
  const again = new MessageWriter(types).writeMessage(value);
  return { value, same: sameBytes(data, again) };
}

/// Makes bytes of values by the definition.
export function encoder(definition) {
  const writer = new MessageWriter(parse(definition, { ros2: true }));
  return (value) => writer.writeMessage(value);
}
