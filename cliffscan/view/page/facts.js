// The base: its motion, its battery, and its sensors that fire.

const OLD = 1; // [s] after which what comes 50 times a second is missed
const list = document.getElementById("base");

export function showFacts({ safety, base, odometry }) {
  const rows = [];
  if (safety) {
    rows.push(["asked", motion(safety.asked)]);
    rows.push(["allowed", motion(safety.allowed), motion(safety.asked) !== motion(safety.allowed)]);
  }
  if (odometry) rows.push(["moves", motion(odometry.twist) + old(odometry)]);
  if (odometry) rows.push(["pose", place(odometry.pose)]);
  if (base) {
    rows.push(["sensors", (base.felt.join(", ") || "nothing touched") + old(base), base.felt.length > 0]);
    rows.push(["battery", `${base.percent.toFixed(0)} %, ${base.voltage.toFixed(1)} V, ${base.charger.replace("_", " ")}`]);
  }
  if (!rows.length) rows.push(["base", "nothing received"]);
  list.replaceChildren(...rows.flatMap(([name, text, alarm]) => [element("dt", name), element("dd", text, alarm)]));
}

function motion([linear, angular]) {
  return `${signed(linear)} m/s, ${signed((angular * 180) / Math.PI, 0)}°/s`;
}

function place([x, y, theta]) {
  return `x ${signed(x)} m, y ${signed(y)} m, ${signed((theta * 180) / Math.PI, 0)}°`;
}

function signed(value, digits = 2) {
  return (value < 0 ? "−" : "+") + Math.abs(value).toFixed(digits);
}

function old({ age }) {
  return age > OLD ? ` (${age.toFixed(0)} s old)` : "";
}

function element(kind, text, alarm = false) {
  const made = document.createElement(kind);
  made.textContent = text;
  made.classList.toggle("alarm", alarm);
  return made;
}
