// Puts it together: one source at a time, everything else only shows what it says.

import { Charts } from "./charts";
import { Controls } from "./controls";
import { Flight } from "./flight";
import { Hud } from "./hud";
import { Live } from "./live";
import { Log } from "./log";
import { element, fixed, note } from "./page";
import { Player } from "./player";
import { World } from "./scene";
import { Sticks } from "./sticks";
import { Trial } from "./trials";
import type { Ask, Listener, Panel, Snapshot, Source, Vec3 } from "./types";

/** Between two positions of the sticks, s. */
const STICKS_EVERY = 0.05;
/** From the first one to a mode that flies by them, ms. */
const STICKS_FIRST = 300;

const world = new World(element<HTMLCanvasElement>("scene"));
const hud = new Hud();
const sticks = new Sticks();
const charts = new Charts(element("strips"), (time) => player?.seek(time));
const controls = new Controls(ask, tryRow);
const dark = window.matchMedia("(prefers-color-scheme: dark)");

let source: Source | null = null;
let player: Player | null = null;
let trial: Trial | null = null;
let panel: Panel | null = null;
let last: Snapshot | null = null;
let sticksAt = 0;

function ask(wanted: Ask): void {
  if (player) note("A log is shown: go back to the flight first.");
  else if (source && wanted.do === "mode" && fliesBySticks(wanted.name) && !sticks.isOn) {
    // Refused without a joystick: it must have been heard first.
    setSticks(true);
    window.setTimeout(() => source?.ask(wanted), STICKS_FIRST);
  } else if (source) source.ask(wanted);
  else note("Nothing flies here.");
}

/** Position holds its place without sticks, but begins with them. */
function fliesBySticks(name: string): boolean {
  return name === "Position" || (panel?.modes.some((mode) => mode.name === name && mode.by_sticks) ?? false);
}

function show(snapshot: Snapshot, pull: Vec3 | null): void {
  last = snapshot;
  hud.show(snapshot);
  world.show(snapshot, pull);
}

const listener: Listener = {
  panel(described) {
    panel = described;
    if (player) return;
    controls.begin(described);
    world.begin(described);
    charts.forget();
  },
  snapshot(snapshot) {
    if (player) return;
    show(snapshot, null);
    controls.show(snapshot);
    charts.push(snapshot);
    if (trial?.step(snapshot)) trial = null;
  },
  note,
};

function pace(speed: number): void {
  const select = element<HTMLSelectElement>("speed");
  select.value = String(speed);
  if (source instanceof Flight) source.speed = speed;
}

function tryRow(row: Panel["failsafes"][number]): void {
  if (!row.trial) return;
  if (source instanceof Flight) {
    trial = new Trial(source, row, (text) => controls.tell(row, text), pace);
  } else {
    ask({ do: "fault", kind: row.trial.kind, value: row.trial.value, ...(row.trial.motor ? { motor: row.trial.motor } : {}) });
  }
}

function label(text: string, isGood: boolean): void {
  element("source").textContent = text;
  element("source").className = `badge ${isGood ? "ready" : ""}`;
}

/** A log is shown, a scenario flown. */
async function openFile(file: File): Promise<void> {
  if (!file.name.endsWith(".toml")) return openLog(file);
  if (!(source instanceof Flight)) return note("Start it with it: cargo sitl --view --scenario FILE.toml");
  try {
    source.restart(await file.text());
    trial = null;
    note(`flies ${file.name}`);
  } catch (why) {
    note(String(why));
  }
}

async function openLog(file: File): Promise<void> {
  note(`reading ${file.name}`);
  try {
    const log = await Log.open(file);
    document.body.classList.add("log");
    world.begin(log.panel());
    player = new Player(log, charts, show);
    label(`log ${file.name}`, true);
    element("back").hidden = source === null;
    note(`${file.name}: ${log.duration.toFixed(0)} s`);
  } catch (error) {
    note(error instanceof Error ? error.message : String(error));
  }
}

function closeLog(): void {
  player?.close();
  player = null;
  document.body.classList.remove("log");
  element("back").hidden = true;
  if (panel) listener.panel(panel);
  label(source?.kind === "wasm" ? "flies in this page" : "live", true);
}

function setSticks(is: boolean): void {
  sticks.isOn = is;
  sticks.rest();
  element<HTMLInputElement>("sticks").checked = is;
  element("stick-state").textContent = "";
}

function fly(now: number, seconds: number): void {
  if (!sticks.isOn || !last || player || now < sticksAt + STICKS_EVERY) return;
  const wanted = sticks.read(last.mode, last.is_armed, sticksAt > 0 ? Math.min(0.2, now - sticksAt) : seconds);
  sticksAt = now;
  ask(wanted);
  const { pitch, roll, yaw, throttle } = wanted;
  element("stick-state").textContent = `P ${fixed(pitch, 1)} R ${fixed(roll, 1)} Y ${fixed(yaw, 1)} T ${fixed(throttle, 1)}`;
}

const KEYS: Record<string, () => void> = {
  Space: () => controls.arm(), KeyT: () => controls.takeOff(), KeyH: () => controls.mode("Tether Hold"),
  KeyL: () => controls.mode("Land"), KeyR: () => controls.mode("Return"), KeyP: () => controls.mode("Position"),
  KeyM: () => ask({ do: "clear" }), KeyJ: () => setSticks(!sticks.isOn), KeyX: () => world.toggleAxes(),
  KeyC: () => world.look(),
};

function press(event: KeyboardEvent): void {
  const place = event.target as HTMLElement;
  const help = element<HTMLDialogElement>("help");
  const writes = place.matches("input:not([type=checkbox]):not([type=range]), select, textarea");
  if (help.open || writes || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "?") help.showModal();
  else if (player?.press(event)) event.preventDefault();
  else if (!player && sticks.press(event.code)) {
    if (!sticks.isOn) {
      setSticks(true);
      sticks.press(event.code);
    }
    event.preventDefault();
  } else if (event.repeat || (event.code === "Space" && place.matches("button, summary, input"))) return;
  else if (/^Digit[1-9]$/.test(event.code)) controls.modeAt(Number(event.code.slice(5)) - 1);
  else {
    KEYS[event.code]?.();
    if (event.code === "Space") event.preventDefault();
  }
}

function wire(): void {
  window.addEventListener("keydown", press);
  window.addEventListener("keyup", (event) => sticks.release(event.code));
  window.addEventListener("blur", () => sticks.rest());
  window.addEventListener("gamepadconnected", () => {
    setSticks(true);
    note("Gamepad: sticks are on");
  });
  element<HTMLInputElement>("sticks").onchange = (event) => setSticks((event.target as HTMLInputElement).checked);
  element("help-open").onclick = () => element<HTMLDialogElement>("help").showModal();
  element("back").onclick = closeLog;
  element("speed").onchange = (event) => pace(Number((event.target as HTMLSelectElement).value));
  element("restart").onclick = () => {
    trial = null;
    if (source instanceof Flight) source.restart();
  };
  const file = element<HTMLInputElement>("file");
  file.onchange = () => {
    const [one] = file.files ?? [];
    if (one) void openFile(one);
    file.value = "";
  };
  window.addEventListener("dragover", (event) => {
    event.preventDefault();
    element("drop").hidden = false;
  });
  window.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) element("drop").hidden = true;
  });
  window.addEventListener("drop", (event) => {
    event.preventDefault();
    element("drop").hidden = true;
    const [one] = event.dataTransfer?.files ?? [];
    if (one) void openFile(one);
  });
  dark.onchange = () => {
    world.recolor(dark.matches);
    charts.build();
  };
  world.recolor(dark.matches);
}

/** Between two frames, ms: what is shown comes 30 times a second. */
const FRAME = 25;

let before = performance.now();
function frame(now: number): void {
  requestAnimationFrame(frame);
  if (now < before + FRAME) return;
  const passed = (now - before) / 1000;
  const seconds = Math.min(0.25, passed);
  before = now;
  fly(now / 1000, seconds);
  if (player) player.advance(seconds);
  else if (source instanceof Flight) source.advance(seconds);
  world.draw(passed);
}

async function start(): Promise<void> {
  wire();
  requestAnimationFrame(frame);
  const module = document.getElementById("wasm");
  if (module) {
    label("starting the simulator", false);
    const bytes = Uint8Array.from(atob(module.textContent ?? ""), (c) => c.charCodeAt(0));
    module.remove();
    source = await Flight.start(bytes, listener);
    element("pace").hidden = element("restart").hidden = false;
    element("failsafe-note").textContent = "A click flies it: up to a hold, the fault, and where it ends.";
    label("flies in this page", true);
  } else if (location.protocol === "http:") {
    source = new Live(listener, (is) => label(is ? "live" : "no flight: is cargo sitl --view running?", is));
  } else {
    label("open or drop a log", false);
  }
}

start().catch((error: unknown) => note(error instanceof Error ? error.message : String(error)));
