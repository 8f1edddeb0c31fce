// How many pictures a second are drawn, and how late.

import { set } from "./why.js";

const WINDOW = 2000; // [ms]
const shown = document.getElementById("pace");

export class Pace {
  constructor() { this.drawn = []; }

  count() {
    this.drawn.push(performance.now());
  }

  show({ latency }) {
    const now = performance.now();
    this.drawn = this.drawn.filter((at) => now - at < WINDOW);
    const rate = (1000 * this.drawn.length) / WINDOW;
    set(shown, rate ? `${rate.toFixed(0)} pictures/s, ${latency ? (1000 * latency).toFixed(0) : "–"} ms` : "no pictures");
  }
}
