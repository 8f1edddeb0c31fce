// What comes is kept, drawn with the screen's next picture, and acknowledged then.

import { Depth } from "./depth.js";
import { showFacts } from "./facts.js";
import { Link } from "./link.js";
import { MapView } from "./map.js";
import { Pace } from "./pace.js";
import { Plan } from "./plan.js";
import { RobotChoice } from "./robots.js";
import { showServices } from "./services.js";
import { StopButton } from "./stop.js";
import { set, showWhy } from "./why.js";

const element = (id) => document.getElementById(id);
const plan = new Plan(element("plan")), depth = new Depth(element("depth")), pace = new Pace();
const map = new MapView(element("drawn"), element("map"), element("maps"));
const link = new Link(received, opened, lost);
const robots = new RobotChoice((robot) => { forget(); link.send({ watch: robot }); });
const stop = new StopButton((message) => link.send(message));
let shown = []; // packets that the next picture shows
let robot = "";

const TAKE = {
  scene: (packet) => { plan.takeScene(packet); pace.count(); },
  ground: (packet) => plan.takeGround(packet),
  depth: (packet) => depth.take(packet),
  map: (packet) => map.take(packet),
  state: showState,
  answer: (packet) => stop.tell(packet.text),
};

async function received(packet) {
  await TAKE[packet.kind](packet);
  if (!shown.length) requestAnimationFrame(draw);
  shown.push(packet);
}

function draw() {
  const kinds = new Set(shown.map((packet) => packet.kind));
  plan.draw();
  if (kinds.has("depth")) depth.draw();
  if (kinds.has("map") || kinds.has("state")) map.draw();
  for (const packet of shown) link.acknowledge(packet);
  shown = [];
}

function showState(state) {
  if (state.robot !== robot) forget();
  robot = state.robot;
  robots.show(state);
  stop.show(state);
  notice(state.notice);
  showWhy(state);
  showFacts(state);
  showServices(state.services);
  pace.show(state);
  plan.takeState(state);
  map.takeState(state);
}

function forget() {
  for (const each of [plan, depth, map]) each.forget();
  depth.draw();
}

function notice(text) {
  set(element("notice"), text);
  element("notice").hidden = !text;
}

function opened() {
  shown = [];
  robots.renew();
}

function lost() {
  notice("cliffscan view does not answer: it was ended, or the way to it is cut. The page goes on when it does.");
  element("why").classList.add("stale");
}
