// Reads what packet.py writes: a header, and its arrays as views of the message's own bytes.

const ARRAYS = { u1: Uint8Array, i1: Int8Array, u2: Uint16Array, f4: Float32Array };
const PREFIX = 8; // bytes

export function readPacket(buffer) {
  const [number, length] = new Uint32Array(buffer, 0, 2);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, PREFIX, length)));
  for (const [name, { type, at, length: values }] of Object.entries(header.arrays)) {
    header[name] = new ARRAYS[type](buffer, PREFIX + length + at, values);
  }
  return { number, ...header };
}
