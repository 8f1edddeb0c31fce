// The robot from above, forward up: what it sees, what the gate remembers, where it is to go and what is in its way.

import { fitted } from "./canvas.js";
import { GroundImage } from "./ground.js";
import { palette } from "./palette.js";
import { drawRobot } from "./robot.js";
import { drawBeams, drawSeenFloor } from "./scan.js";
import { commandedWay, drawWay } from "./way.js";

const AHEAD = 3.1, BEHIND = 0.9, ASIDE = 2.0; // [m] that are shown at least,
const CLOSER = 0.5; // of it while something near holds the robot,
const NEAR = 0.5; // [m] to go
const RINGS = [0.5, 1, 2, 3]; // [m]
const OLD = 1; // [s]
const HOLDS = ["slowed", "held", "alarm"];

export class Plan {
  constructor(canvas) {
    this.canvas = canvas;
    this.image = new GroundImage();
    this.state = {};
    this.shown = 1; // of what is shown otherwise
  }

  takeScene(scene) { this.scene = scene; }
  takeGround(ground) { this.image.take(ground); this.obstruction = ground.obstruction; }

  takeState(state) {
    this.state = state;
    const { level, distance } = state.safety ?? {};
    if (!HOLDS.includes(level)) this.shown = 1;
    else if (distance >= 0 && distance < NEAR) this.shown = CLOSER; // until it is free again, so that it does not flicker
  }

  forget() { this.scene = this.obstruction = undefined; this.image = new GroundImage(); this.state = {}; }

  draw() {
    const { context, width, height, scale: pixels } = fitted(this.canvas);
    const scale = Math.min(width / (2 * ASIDE), height / (AHEAD + BEHIND)) / this.shown;
    const middle = [width / 2, (height + (AHEAD - BEHIND) * this.shown * scale) / 2];
    const place = (x, y) => [middle[0] - y * scale, middle[1] - x * scale];
    const { safety, base, odometry, scan_age: age, radius = 0.18, footprint = [] } = this.state;
    const pose = this.scene?.pose && !(age > OLD) ? this.scene.pose : odometry?.pose;
    const inOdometry = (draw) => {
      if (!pose) return;
      context.save();
      context.setTransform(0, -scale, -scale, 0, ...middle);
      context.rotate(-pose[2]);
      context.translate(-pose[0], -pose[1]);
      draw();
      context.restore();
    };
    inOdometry(() => this.image.draw(context));
    if (this.scene) {
      context.globalAlpha = age > OLD ? 0.3 : 1;
      drawSeenFloor(context, this.scene, place);
      drawBeams(context, this.scene, place, 4 * pixels);
      context.globalAlpha = 1;
    }
    this.drawRings(context, place, scale, pixels);
    const way = safety && commandedWay(safety);
    if (way) drawWay(context, way, radius, place, scale, palette.ink);
    drawRobot(context, radius, footprint, base, place, scale);
    if (safety && HOLDS.includes(safety.level)) this.drawObstruction(context, pose, place, pixels);
    if (age > OLD) label(context, `the scan is ${age.toFixed(0)} s old`, width / 2, 24 * pixels, pixels);
  }

  drawRings(context, place, scale, pixels) {
    context.strokeStyle = palette.line;
    context.fillStyle = palette.faint;
    context.font = `${12 * pixels}px system-ui, sans-serif`;
    context.lineWidth = 1;
    for (const range of RINGS) {
      context.beginPath();
      context.arc(...place(0, 0), range * scale, 0, 7);
      context.stroke();
      const [u, v] = place(range, 0);
      context.fillText(`${range} m`, u + 4, v - 4);
    }
  }

  // What is met first: a target that stands out on any ground, and its name.
  drawObstruction(context, pose, place, pixels) {
    if (!this.obstruction || !pose) return;
    const dx = this.obstruction.x - pose[0], dy = this.obstruction.y - pose[1];
    const cos = Math.cos(pose[2]), sin = Math.sin(pose[2]);
    const [u, v] = place(cos * dx + sin * dy, cos * dy - sin * dx);
    for (const [colour, width] of [[palette.page, 7], [palette.ink, 3]]) {
      context.strokeStyle = colour;
      context.lineWidth = width * pixels;
      context.beginPath();
      context.arc(u, v, 13 * pixels, 0, 7);
      context.stroke();
    }
    label(context, this.obstruction.kind, u, v - 22 * pixels, pixels);
  }
}

function label(context, text, u, v, pixels) {
  context.font = `600 ${16 * pixels}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.lineWidth = 4 * pixels;
  context.strokeStyle = palette.page;
  context.fillStyle = palette.ink;
  context.strokeText(text, u, v);
  context.fillText(text, u, v);
  context.textAlign = "start";
}
