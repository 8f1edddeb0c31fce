// The way that is commanded: the band that the robot's disc sweeps along its arc, and where it has to end.

const STRAIGHT = 1e-6; // [1/m]
const AHEAD = 1.5; // [s] of a way that nothing ends
const STEP = 0.05; // [m]

// The pose on the way after `length` [m], which is negative backward.
export function poseAt(curvature, length) {
  if (Math.abs(curvature) < STRAIGHT) return [length, 0, 0];
  const turn = curvature * length;
  return [Math.sin(turn) / curvature, (1 - Math.cos(turn)) / curvature, turn];
}

// How far the commanded way goes, and whether the gate ends it there; null where the robot only turns or stands.
export function commandedWay(safety) {
  const [linear, angular] = safety.asked;
  if (linear === 0) return null;
  const ends = safety.distance >= 0;
  const length = ends ? safety.distance : Math.abs(linear) * AHEAD;
  return { curvature: angular / linear, length: Math.sign(linear) * length, ends };
}

export function drawWay(context, way, radius, place, scale, colour) {
  const steps = Math.max(Math.ceil(Math.abs(way.length) / STEP), 1);
  const left = [], right = [];
  for (let step = 0; step <= steps; step++) {
    const [x, y, theta] = poseAt(way.curvature, (way.length * step) / steps);
    left.push(place(x - radius * Math.sin(theta), y + radius * Math.cos(theta)));
    right.push(place(x + radius * Math.sin(theta), y - radius * Math.cos(theta)));
  }
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.setLineDash([8, 5]);
  context.beginPath();
  for (const side of [left, right]) {
    side.forEach((point, index) => (index ? context.lineTo(...point) : context.moveTo(...point)));
  }
  context.stroke();
  const [x, y] = poseAt(way.curvature, way.length);
  context.setLineDash(way.ends ? [] : [8, 5]);
  context.lineWidth = way.ends ? 4 : 2;
  context.beginPath();
  context.arc(...place(x, y), radius * scale, 0, 7);
  context.stroke();
  context.setLineDash([]);
}
