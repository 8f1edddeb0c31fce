// How the services fare: what `cliffscan status` prints.

const table = document.getElementById("services"), notes = document.getElementById("notes");

export function showServices(services = []) {
  table.replaceChildren(...services.map(row));
  notes.replaceChildren(...services.flatMap(({ name, notes: each }) => each.map((note) => item(`${name}: ${note}`))));
}

function row({ name, state, rate, latency }) {
  const made = document.createElement("tr");
  const cells = [name, state, rate?.toFixed(1) ?? "", latency ? (1000 * latency[0]).toFixed(1) : ""];
  cells.forEach((text, column) => {
    const cell = made.insertCell();
    cell.textContent = text;
    cell.classList.toggle("alarm", column === 1 && state !== "working" && state !== "alive");
  });
  return made;
}

function item(text) {
  const made = document.createElement("li");
  made.textContent = text;
  return made;
}
