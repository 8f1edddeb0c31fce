// The emergency stop, at one touch, and its release, which is asked for again.

const SHOWN = 4000; // [ms]
const [stop, clear, sure, whose, answer] = ["stop", "clear", "sure", "whose", "answer"].map((id) => document.getElementById(id));

export class StopButton {
  constructor(ask) {
    this.ask = ask;
    stop.addEventListener("click", () => this.send("stop"));
    clear.addEventListener("click", () => {
      this.asked = this.robot; // another may be chosen meanwhile
      whose.textContent = this.robot;
      sure.showModal();
    });
    sure.addEventListener("close", () => {
      if (sure.returnValue === "clear") this.send("clear_safety", this.asked);
      sure.returnValue = "";
    });
  }

  send(name, robot = this.robot) {
    const sent = this.ask({ ask: name, robot });
    this.tell(sent ? `${name}: asked` : `${name}: NOT SENT, for the page's server does not answer`);
  }

  show({ robot, safety }) {
    this.robot = robot;
    clear.hidden = !safety?.latched;
  }

  tell(text) {
    answer.textContent = text;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (answer.textContent = ""), SHOWN);
  }
}
