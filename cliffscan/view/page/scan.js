// A fused scan from above: the floor that was seen, and each beam's number by what it rests on.

import { palette } from "./palette.js";

const UNSEEN = 0, FREE = 65535; // as scene.py has them
const NAMES = ["ink", "positive", "drop", "lost", "farthest", "extra"]; // by evidence
const APART = 4; // sizes of a dot between two marks
const SHAPES = [
  (path, x, y, r) => { path.moveTo(x - r, y - r); path.lineTo(x + r, y + r); path.moveTo(x + r, y - r); path.lineTo(x - r, y + r); },
  (path, x, y, r) => path.rect(x - r, y - r, 2 * r, 2 * r),
  (path, x, y, r) => { path.moveTo(x - r, y - r); path.lineTo(x + r, y - r); path.lineTo(x, y + r); path.closePath(); },
  (path, x, y, r) => { path.moveTo(x, y - r); path.lineTo(x + r, y); path.lineTo(x, y + r); path.lineTo(x - r, y); path.closePath(); },
  (path, x, y, r) => { path.moveTo(x + r, y); path.arc(x, y, r, 0, 7); },
  (path, x, y, r) => { path.rect(x - r, y - r / 3, 2 * r, r / 1.5); path.rect(x - r / 3, y - r, r / 1.5, 2 * r); },
];

// place(x, y): where a point [m] of the robot's frame is on the canvas.
export function drawSeenFloor(context, scan, place) {
  const [x0, y0, yaw] = scan.camera;
  context.beginPath();
  context.moveTo(...place(x0, y0));
  for (let beam = 0; beam < scan.clear.length; beam++) {
    const range = scan.clear[beam] / 1000, angle = yaw + scan.angle_min + beam * scan.increment;
    context.lineTo(...place(x0 + range * Math.cos(angle), y0 + range * Math.sin(angle)));
  }
  context.fillStyle = palette.seen;
  context.fill();
}

export function drawBeams(context, scan, place, size) {
  const [x0, y0, yaw] = scan.camera;
  const dots = NAMES.map(() => new Path2D()), marks = NAMES.map(() => new Path2D());
  const last = NAMES.map(() => [-Infinity, 0]);
  for (let beam = 0; beam < scan.ranges.length; beam++) {
    const millimetres = scan.ranges[beam];
    if (millimetres === UNSEEN || millimetres === FREE) continue;
    const evidence = Math.min(scan.evidence[beam], NAMES.length - 1);
    const range = millimetres / 1000, angle = yaw + scan.angle_min + beam * scan.increment;
    const [u, v] = place(x0 + range * Math.cos(angle), y0 + range * Math.sin(angle));
    dots[evidence].rect(u - size / 2, v - size / 2, size, size);
    if (Math.hypot(u - last[evidence][0], v - last[evidence][1]) >= APART * size) {
      SHAPES[evidence](marks[evidence], u, v, 1.7 * size);
      last[evidence] = [u, v];
    }
  }
  context.lineWidth = size / 4;
  for (const [evidence, name] of NAMES.entries()) {
    context.fillStyle = palette[name];
    context.fill(dots[evidence]);
    context.fill(marks[evidence]);
    context.strokeStyle = evidence ? palette.page : palette.ink;
    context.stroke(marks[evidence]);
  }
}
