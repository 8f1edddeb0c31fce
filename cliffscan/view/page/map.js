// The map of a SLAM as it grows, and the robot on it.

import { fitted } from "./canvas.js";
import { palette, rgb } from "./palette.js";

const NAMES = ["free", "ink", "unknown"]; // by the picture's values: free, occupied, unknown
const LEAST = 4; // [m] that are shown

export class MapView {
  constructor(figure, canvas, choice) {
    this.figure = figure;
    this.canvas = canvas;
    this.choice = choice;
    this.forget();
  }

  forget() {
    this.maps = new Map();
    this.poses = {};
    this.choice.replaceChildren();
    this.figure.hidden = true;
  }

  async take(packet) {
    const bitmap = await createImageBitmap(new Blob([packet.png], { type: "image/png" }));
    const { width, height } = packet;
    const image = document.createElement("canvas");
    image.width = width;
    image.height = height;
    const context = image.getContext("2d", { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    const pixels = context.getImageData(0, 0, width, height), values = pixels.data;
    const colours = NAMES.map((name) => rgb(palette[name]));
    let box = null; // of what is known
    for (let cell = 0; cell < width * height; cell++) {
      const value = values[4 * cell];
      if (value < 2) box = grown(box, cell % width, Math.floor(cell / width));
      values.set(colours[Math.min(value, 2)], 4 * cell);
    }
    context.putImageData(pixels, 0, 0);
    bitmap.close();
    if (!this.maps.has(packet.name)) this.choice.add(new Option(packet.name || "map", packet.name));
    this.choice.hidden = this.choice.length < 2;
    this.maps.set(packet.name, { ...packet, image, box });
    if (packet.name === "" || packet.name === "fused") this.choice.value ||= packet.name;
    this.figure.hidden = false;
  }

  takeState(state) { this.poses = state.poses || {}; }

  draw() {
    const map = this.maps.get(this.choice.value);
    if (!map || !map.box) return;
    const { context, width, height, scale } = fitted(this.canvas);
    const { image, box, resolution, origin } = map;
    const cells = LEAST / resolution;
    const wide = Math.max(box.right - box.left + 1, cells), high = Math.max(box.top - box.bottom + 1, cells);
    const zoom = 0.95 * Math.min(width / wide, height / high);
    const column = (box.left + box.right + 1) / 2, row = (box.bottom + box.top + 1) / 2;
    context.setTransform(zoom, 0, 0, -zoom, width / 2 - zoom * column, height / 2 + zoom * row); // y is up
    context.imageSmoothingEnabled = false;
    context.drawImage(image, 0, 0);
    const pose = this.poses[map.name];
    if (pose) drawPose(context, pose, origin, resolution, scale / zoom);
  }
}

function grown(box, column, row) {
  if (!box) return { left: column, right: column, bottom: row, top: row };
  box.left = Math.min(box.left, column);
  box.right = Math.max(box.right, column);
  box.top = row;
  return box;
}

// An arrow of 14 pixels in the map's cells; `pixel` is one in cells.
function drawPose(context, [x, y, theta], [x0, y0, turned], resolution, pixel) {
  const dx = x - x0, dy = y - y0, cos = Math.cos(turned), sin = Math.sin(turned);
  context.translate((cos * dx + sin * dy) / resolution, (cos * dy - sin * dx) / resolution);
  context.rotate(theta - turned);
  context.scale(pixel, pixel);
  context.beginPath();
  context.moveTo(14, 0);
  context.lineTo(-9, 9);
  context.lineTo(-9, -9);
  context.closePath();
  context.fillStyle = palette.positive;
  context.strokeStyle = palette.page;
  context.lineWidth = 3;
  context.stroke();
  context.fill();
}
