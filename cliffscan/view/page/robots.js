// The choice of a robot. Until a person chooses, it is the one that is there.

const choice = document.getElementById("robots");

export class RobotChoice {
  constructor(choose) {
    this.choose = choose;
    this.chosen = decodeURIComponent(location.hash.slice(1));
    choice.addEventListener("change", () => this.take(choice.value));
  }

  take(robot) {
    this.chosen = robot;
    history.replaceState(null, "", `#${encodeURIComponent(robot)}`);
    this.choose(robot);
  }

  // Ask again for what was chosen, on a new connection.
  renew() {
    if (this.chosen) this.choose(this.chosen);
  }

  show({ robot, robots, found }) {
    if (String([...choice.options].map((option) => option.value)) !== String(robots)) {
      choice.replaceChildren(...robots.map((name) => new Option(name, name)));
    }
    choice.value = robot;
    const other = robots.find((name) => name !== robot);
    if (!this.chosen && !found && other) this.choose(other);
  }
}
