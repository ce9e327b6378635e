// What is read at a glance: mode, motors, numbers beside each other, failsafes, texts.

import { degrees } from "./frames";
import { element, fixed } from "./page";
import type { Snapshot } from "./types";

/** Texts that are shown. */
const TEXTS = 5;

const deg = (x: number | null | undefined): number | null => (x === null || x === undefined ? null : degrees(x));

type Row = [name: string, id: string, truth: string, estimate: string];

function rows(s: Snapshot): Row[] {
  const { truth: t, estimate: e } = s;
  const speed = t ? Math.hypot(...t.velocity_mps) : null;
  const wind = t?.wind_mps;
  const from = wind && Math.hypot(...wind) > 0.05 ? (degrees(Math.atan2(-wind[1], -wind[0])) + 360) % 360 : null;
  return [
    ["height", "height", `${fixed(t?.height_m, 2)} m`, `${fixed(e.height_m, 2)} m`],
    ["elevation", "elevation", `${fixed(deg(t?.elevation_rad), 1)}°`, `${fixed(deg(e.elevation_rad), 1)}°`],
    ["azimuth", "azimuth", `${fixed(deg(t?.azimuth_rad), 1)}°`, `${fixed(deg(e.azimuth_rad), 1)}°`],
    ["tension", "tension", `${fixed(t?.tension_n, 1)} N`, `${fixed(e.tension_n, 1)} N`],
    ["line", "line", `${fixed(t?.line_length_m, 2)} m`, `${fixed(s.winch_tension_n, 1)} N asked`],
    ["speed", "speed", `${fixed(speed, 2)} m/s`, ""],
    ["wind", "wind", wind ? `${fixed(Math.hypot(...wind), 1)} m/s` : "–", from === null ? "" : `from ${fixed(from, 0)}°`],
  ];
}

export class Hud {
  private readonly cells = new Map<string, [HTMLElement, HTMLElement]>();
  private lastTexts = "";
  private lastFailures = "";
  private pace: [wall: number, time: number] | null = null;

  show(s: Snapshot): void {
    element("mode").textContent = s.mode;
    const armed = element("armed");
    armed.textContent = s.is_armed ? (s.is_in_air ? "flying" : "armed") : s.is_armable ? "ready" : "not ready";
    armed.className = `badge ${s.is_armed ? "on" : s.is_armable ? "ready" : ""}`;
    element("time").textContent = s.time_s.toFixed(1);
    const b = s.battery;
    element("battery").textContent = b ? `${b.voltage_v.toFixed(1)} V ${Math.round(100 * b.remaining)} %` : "–";
    for (const row of rows(s)) this.row(row);
    this.failures(s.failures);
    this.texts(s);
    this.factor(s.time_s);
  }

  private row([name, id, truth, estimate]: Row): void {
    let cells = this.cells.get(name);
    if (!cells) {
      const make = (tag: string, kind: string) => {
        const cell = document.createElement(tag);
        cell.className = kind;
        element("readings").append(cell);
        return cell;
      };
      make("dt", "").textContent = name;
      cells = [make("dd", "truth"), make("dd", "estimate")];
      cells[0].id = id;
      cells[0].setAttribute("aria-label", `${name}, truth`);
      cells[1].setAttribute("aria-label", `${name}, estimate`);
      this.cells.set(name, cells);
    }
    cells[0].textContent = truth;
    cells[1].textContent = estimate;
  }

  private failures(active: string[]): void {
    const key = active.join("\n");
    if (key === this.lastFailures) return;
    this.lastFailures = key;
    element("failures").replaceChildren(...active.map((text) => {
      const line = document.createElement("span");
      line.textContent = text;
      return line;
    }));
  }

  private texts(s: Snapshot): void {
    const last = s.texts.slice(-TEXTS);
    const key = JSON.stringify(last);
    if (key === this.lastTexts) return;
    this.lastTexts = key;
    element("texts").replaceChildren(...last.map(({ time_s, severity, text }) => {
      const line = document.createElement("li");
      line.className = `s${severity}`;
      line.textContent = `${time_s.toFixed(1)} s  ${text}`;
      return line;
    }));
  }

  /** Simulated per real seconds, over about a second. */
  private factor(time: number): void {
    const wall = performance.now() / 1000;
    const [before, then] = this.pace ?? [wall, time];
    if (!this.pace || time < then) this.pace = [wall, time];
    if (wall - before < 1) return;
    element("factor").textContent = ((time - then) / (wall - before)).toFixed(1);
    this.pace = [wall, time];
  }
}
