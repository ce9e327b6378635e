// Buttons, forms and tables: what may be asked for.

import { element } from "./page";
import type { Ask, FailsafeRow, FaultButton, Panel, Snapshot } from "./types";

const value = (name: string, form: HTMLFormElement): number | undefined => {
  const text = (form.elements.namedItem(name) as HTMLInputElement).value;
  return text === "" ? undefined : Number(text);
};
const radians = (x: number | undefined): number | undefined => (x === undefined ? undefined : (x * Math.PI) / 180);

export class Controls {
  private modes: { name: string; button: HTMLButtonElement }[] = [];
  private rows: { row: FailsafeRow; line: HTMLTableRowElement; here: HTMLElement }[] = [];
  private readonly ends = new Map<string, string>();
  private faults: FaultButton[] = [];
  private active = "";
  private last: Snapshot | null = null;

  constructor(private readonly ask: (ask: Ask) => void, private readonly tryRow: (row: FailsafeRow) => void) {
    element("arm").onclick = () => this.arm();
    element("takeoff").onclick = () => this.takeOff();
    element("clear").onclick = () => ask({ do: "clear" });
    element("kill").onclick = () => {
      if (!this.last?.is_in_air || window.confirm("Stop the motors in the air? The vehicle falls.")) ask({ do: "terminate" });
    };
    element<HTMLFormElement>("move").onsubmit = (event) => this.move(event);
    element<HTMLFormElement>("fault").onsubmit = (event) => this.inject(event);
    element<HTMLSelectElement>("fault-kind").onchange = () => this.describe();
  }

  begin(panel: Panel): void {
    element<HTMLInputElement>("altitude").value = String(panel.takeoff_altitude_m);
    this.modes = panel.modes.map(({ name, by_sticks }) => {
      const button = document.createElement("button");
      button.textContent = name;
      if (by_sticks) button.title = "flies by sticks";
      button.onclick = () => this.ask({ do: "mode", name });
      return { name, button };
    });
    element("modes").replaceChildren(...this.modes.map(({ button }) => button));
    this.faults = panel.faults;
    element("fault-kind").replaceChildren(...panel.faults.map(({ kind }) => new Option(kind.replaceAll("_", " "), kind)));
    this.describe();
    this.rows = panel.failsafes.map((row) => this.row(row));
    element("failsafes").replaceChildren(...this.rows.map(({ line }) => line));
    this.active = "";
  }

  private row(row: FailsafeRow): { row: FailsafeRow; line: HTMLTableRowElement; here: HTMLElement } {
    const line = document.createElement("tr");
    const [says, does, here] = [line.insertCell(), line.insertCell(), line.insertCell()];
    if (row.trial) {
      const button = document.createElement("button");
      button.textContent = row.text;
      button.title = `breaks ${row.trial.kind}${row.trial.value ? ` ${row.trial.value}` : ""}`;
      button.onclick = () => this.tryRow(row);
      says.append(button);
      here.textContent = this.ends.get(row.text) ?? "";
    } else {
      says.textContent = row.text;
      here.textContent = "in another mode, phase or vehicle";
    }
    does.textContent = row.action + (row.delay_s > 0 ? `, after ${row.delay_s} s` : "");
    return { row, line, here };
  }

  /** What a row's flight has come to; it stays through the next ones. */
  tell(row: FailsafeRow, text: string): void {
    this.ends.set(row.text, text);
    const found = this.rows.find((one) => one.row.text === row.text);
    if (found) found.here.textContent = text;
  }

  show(s: Snapshot): void {
    this.last = s;
    for (const { name, button } of this.modes) {
      button.classList.toggle("current", name === s.mode);
      button.setAttribute("aria-pressed", String(name === s.mode));
    }
    element("arm").textContent = s.is_armed ? "Disarm" : "Arm";
    for (const { row, line } of this.rows) line.classList.toggle("on", s.failures.includes(row.text));
    const key = s.faults.join();
    if (key === this.active) return;
    this.active = key;
    element("active").replaceChildren(...s.faults.map((kind) => {
      const button = document.createElement("button");
      button.className = "danger";
      button.textContent = `${kind.replaceAll("_", " ")} ×`;
      button.onclick = () => this.ask({ do: "clear", kind });
      return button;
    }));
  }

  arm(): void {
    this.ask({ do: this.last?.is_armed ? "disarm" : "arm" });
  }

  takeOff(): void {
    this.ask({ do: "takeoff", altitude_m: Number(element<HTMLInputElement>("altitude").value) });
  }

  mode(name: string): void {
    if (this.modes.some((mode) => mode.name === name)) this.ask({ do: "mode", name });
  }

  /** In the order of the buttons, from 0. */
  modeAt(at: number): void {
    const mode = this.modes[at];
    if (mode) this.ask({ do: "mode", name: mode.name });
  }

  private move(event: SubmitEvent): void {
    event.preventDefault();
    const form = element<HTMLFormElement>("move");
    const [elevation, azimuth] = [radians(value("elevation", form)), radians(value("azimuth", form))];
    const [length, tension] = [value("length", form), value("tension", form)];
    this.ask({
      do: "move",
      ...(elevation === undefined ? {} : { elevation_rad: elevation }),
      ...(azimuth === undefined ? {} : { azimuth_rad: azimuth }),
      ...(length === undefined ? {} : { length_m: length }),
      ...(tension === undefined ? {} : { tension_n: tension }),
    });
  }

  private chosen(): FaultButton | undefined {
    const { value: kind } = element<HTMLSelectElement>("fault-kind");
    return this.faults.find((fault) => fault.kind === kind);
  }

  private describe(): void {
    const fault = this.chosen();
    const input = element<HTMLInputElement>("fault-value");
    input.hidden = !fault || fault.unit === null;
    input.min = String(fault?.least ?? "");
    input.max = String(fault?.most ?? "");
    input.value = "";
    input.placeholder = fault ? `${fault.least} to ${fault.most}` : "";
    element("fault-unit").textContent = fault?.unit ?? "";
    element("fault-doc").textContent = fault?.doc ?? "";
  }

  private inject(event: SubmitEvent): void {
    event.preventDefault();
    const fault = this.chosen();
    if (fault) this.ask({ do: "fault", kind: fault.kind, value: Number(element<HTMLInputElement>("fault-value").value) });
  }
}
