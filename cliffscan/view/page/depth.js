// The depth image, and over it where the scan says that the floor ends.

import { fitted } from "./canvas.js";

const FAR = 24; // [px] of the depth image between two beams whose edges are not one line

export class Depth {
  constructor(canvas) {
    this.canvas = canvas;
  }

  async take(packet) {
    const bitmap = await createImageBitmap(new Blob([packet.jpeg], { type: "image/jpeg" }));
    this.bitmap?.close();
    this.bitmap = bitmap;
    this.packet = packet;
  }

  forget() { this.bitmap = undefined; }

  draw() {
    const { context, width, height, scale } = fitted(this.canvas);
    if (!this.bitmap) return;
    const { u, v, width: columns, height: rows } = this.packet;
    const zoom = Math.min(width / columns, height / rows);
    const left = (width - columns * zoom) / 2, top = (height - rows * zoom) / 2;
    context.drawImage(this.bitmap, left, top, columns * zoom, rows * zoom);
    const line = new Path2D();
    for (let beam = 0; beam < u.length; beam++) {
      if (Number.isNaN(u[beam])) continue;
      const point = [left + u[beam] * zoom, top + v[beam] * zoom];
      const joined = beam && Math.hypot(u[beam] - u[beam - 1], v[beam] - v[beam - 1]) < FAR;
      joined ? line.lineTo(...point) : line.moveTo(...point);
    }
    context.lineJoin = context.lineCap = "round";
    for (const [colour, thickness] of [["#000", 6], ["#fff", 3]]) {
      context.strokeStyle = colour;
      context.lineWidth = thickness * scale;
      context.stroke(line);
    }
  }
}
