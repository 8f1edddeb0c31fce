// The socket to the server. It comes back by itself; each packet is acknowledged once it is shown, not before:
// the server sends no more than two that are not, so nothing piles up here.

import { readPacket } from "./packet.js";

const AGAIN = 1000; // [ms]

export class Link {
  constructor(received, opened, lost) {
    this.received = received;
    this.opened = opened;
    this.lost = lost;
    this.connect();
  }

  connect() {
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    address.search = location.search; // the token
    const socket = new WebSocket(address, "cliffscan.view.v1");
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.opened();
    socket.onmessage = (event) => this.received(readPacket(event.data));
    socket.onclose = () => {
      this.lost();
      setTimeout(() => this.connect(), AGAIN);
    };
    this.socket = socket;
  }

  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  acknowledge(packet) {
    this.send({ ack: packet.number });
  }
}
