// Why the robot does what it does, in words.

const OLD = 2.5; // [s] after which what comes once a second is missed
const [section, headline, reason, remedy] = ["why", "headline", "reason", "remedy"].map((id) => document.getElementById(id));

export function showWhy(state) {
  const safety = state.safety;
  section.dataset.level = safety?.level ?? "quiet";
  section.dataset.rule = safety?.rule ?? "";
  section.classList.toggle("stale", !safety || safety.age > OLD);
  set(headline, safety ? safety.headline : "Nothing received from a gate");
  set(reason, safety ? sentence(safety.reason) : "");
  set(remedy, !safety ? "" : safety.age > OLD ? `This is ${safety.age.toFixed(0)} s old.` : safety.remedy);
}

function sentence(text) {
  return text ? text[0].toUpperCase() + text.slice(1) + "." : "";
}

export function set(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
