// The gate's grid as an image of one pixel a cell.

import { palette, rgb } from "./palette.js";

const CELL = 0.04; // [m]
const NAMES = ["free", "guessed", "unknown", "positive", "drop", "touched"]; // by the state of a cell

export class GroundImage {
  constructor() {
    this.canvas = document.createElement("canvas");
  }

  take(ground) {
    const { rows, columns, cells } = ground;
    this.canvas.width = rows; // rows go along x
    this.canvas.height = columns;
    const context = this.canvas.getContext("2d");
    const image = context.createImageData(rows, columns);
    const colours = NAMES.map((name) => rgb(palette[name]));
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        const at = 4 * (column * rows + row);
        image.data.set(colours[cells[row * columns + column]], at);
        image.data[at + 3] = 255;
      }
    }
    context.putImageData(image, 0, 0);
    this.ground = ground;
  }

  // The context's units are metres of the odometry's frame.
  draw(context) {
    if (!this.ground) return;
    const { x, y, rows, columns } = this.ground;
    context.imageSmoothingEnabled = false;
    context.drawImage(this.canvas, x, y, rows * CELL, columns * CELL);
  }
}
