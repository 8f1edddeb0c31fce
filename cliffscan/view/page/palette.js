// The colours of the style sheet, for canvases.

const NAMES = ["positive", "drop", "lost", "farthest", "extra", "ink", "faint", "page", "line",
  "unknown", "free", "guessed", "seen", "robot", "touched"];

export const palette = {};

function read() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) palette[name] = style.getPropertyValue(`--${name}`).trim();
}

read();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", read);

export function rgb(colour) {
  const value = parseInt(colour.slice(1, 7), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
