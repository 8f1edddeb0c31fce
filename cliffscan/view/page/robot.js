// The robot from above, with the sensors that fire.

import { palette } from "./palette.js";

const SIDE = (50 * Math.PI) / 180; // where on the rim the outer sensors are
const HALF = (20 * Math.PI) / 180;

export function drawRobot(context, radius, footprint, base, place, scale) {
  const [u, v] = place(0, 0);
  context.fillStyle = palette.robot;
  context.globalAlpha = 0.85;
  context.beginPath();
  if (footprint.length) footprint.forEach(([x, y]) => context.lineTo(...place(x, y)));
  else context.arc(u, v, radius * scale, 0, 7);
  context.fill();
  context.globalAlpha = 1;
  context.fillStyle = palette.page;
  context.beginPath();
  context.moveTo(...place(0.75 * radius, 0));
  context.lineTo(...place(-0.35 * radius, 0.45 * radius));
  context.lineTo(...place(-0.35 * radius, -0.45 * radius));
  context.fill();
  if (!base) return;
  [SIDE, 0, -SIDE].forEach((bearing, side) => {
    if (base.cliffs[side]) rim(context, u, v, radius * scale, bearing, palette.drop);
    if (base.bumpers[side]) rim(context, u, v, radius * scale, bearing, palette.positive);
  });
}

// A piece of the rim; the canvas has forward up, so a bearing to the left turns against the clock.
function rim(context, u, v, radius, bearing, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 10;
  context.beginPath();
  context.arc(u, v, radius, -Math.PI / 2 - bearing - HALF, -Math.PI / 2 - bearing + HALF);
  context.stroke();
}
