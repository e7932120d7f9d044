// SPDX-License-Identifier: Apache-2.0
// The live view in the hands of a client that others wrote; one JSON object on stdout.
//
//   node viewer_tool.mjs PORT SUBPROTOCOL TOPIC...    @foxglove/ws-protocol
//
// Subscribes to every channel, decodes each message by the definition that the channel has, and encodes it
// again. Asks for a global localization where that is offered. Ends when all those topics have come and the
// service has answered, or after a minute with 1 and what came until then.
import { createRequire } from "node:module";
import { decode } from "./decode.mjs";

const require = createRequire(import.meta.url);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [port, protocol, ...wanted] = process.argv.slice(2);
const kPatienceMs = 60_000;
const kService = "reinitialize_global_localization";
const found = { protocol: "", topics: {}, without: [], different: [], answer: "" };
const socket = new WebSocket(`ws://localhost:${port}`, [protocol]);
const client = new FoxgloveClient({ ws: socket });
const channels = new Map();
let isAsked = false;

function end(code) {
  found.protocol = socket.protocol;
  for (const channel of channels.values()) {
    if (!(channel.topic in found.topics)) found.without.push(channel.topic);
  }
  console.log(JSON.stringify(found));
  process.exit(code);
}

function endIfDone() {
  const isAnswered = !isAsked || found.answer !== "";
  if (isAnswered && wanted.every((topic) => topic in found.topics)) end(0);
}

client.on("error", (error) => {
  console.error(String(error));
  end(1);
});
client.on("advertise", (all) => {
  for (const channel of all) channels.set(client.subscribe(channel.id), channel);
});
client.on("message", ({ subscriptionId, data }) => {
  const { topic, schemaName, schema, schemaEncoding, encoding } = channels.get(subscriptionId);
  const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  if (!decode(schema, bytes).same) found.different.push(topic);
  found.topics[topic] ??= { type: schemaName, encoding, schemaEncoding, count: 0 };
  found.topics[topic].count += 1;
  endIfDone();
});
client.on("advertiseServices", (services) => {
  const service = services.find((one) => one.name.endsWith(kService));
  if (service === undefined) return;
  isAsked = true;
  const empty = new Uint8Array([0, 1, 0, 0, 0]);  // CDR of a message without fields
  client.sendServiceCallRequest({
    serviceId: service.id,
    callId: 1,
    encoding: "cdr",
    data: new DataView(empty.buffer),
  });
});
client.on("serviceCallResponse", (response) => {
  found.answer = `call ${response.callId}`;
  endIfDone();
});
client.on("serviceCallFailure", (failure) => {
  found.answer = `refused: ${failure.message}`;
  endIfDone();
});
setTimeout(() => end(1), kPatienceMs);
