// The whole simulator and firmware in this page.

import init, { Simulation } from "simulation";
import type { Ask, Listener, Message, Source } from "./types";

/** Of each frame, spent on the simulation at most, ms; and simulated at a time. */
const BUDGET = 14;
const SLICE = 25;

export class Flight implements Source {
  readonly kind = "wasm";
  speed = 1;
  private simulation: Simulation;
  private owed = 0;

  private constructor(private readonly listener: Listener, private scenario: string, private readonly seed: number) {
    this.simulation = new Simulation(scenario, seed);
    this.describe();
  }

  static async start(module: Uint8Array<ArrayBuffer>, listener: Listener): Promise<Flight> {
    await init({ module_or_path: module });
    const query = new URLSearchParams(location.search);
    return new Flight(listener, query.get("scenario") ?? "", Number(query.get("seed") ?? 1));
  }

  /** From the ground again, with the same seed; a scenario that is wrong is thrown back in one line. */
  restart(scenario = this.scenario): void {
    const next = new Simulation(scenario, this.seed);
    this.scenario = scenario;
    this.simulation.free();
    this.simulation = next;
    this.owed = 0;
    this.describe();
  }

  private describe(): void {
    const message = JSON.parse(this.simulation.panel()) as Message;
    if (message.type === "panel") this.listener.panel(message);
  }

  /** `seconds` of real time have passed. */
  advance(seconds: number): void {
    this.owed += seconds * this.speed * 1000;
    const began = performance.now();
    while (this.owed >= 1 && performance.now() < began + BUDGET) {
      const slice = Math.min(SLICE, Math.floor(this.owed));
      this.simulation.step(slice);
      this.owed -= slice;
    }
    // What this machine could not do in time is not done later.
    this.owed = Math.min(this.owed, 1);
    this.tell();
  }

  /** So much simulated time at once. */
  leap(ms: number): void {
    this.simulation.step(ms);
    this.tell();
  }

  private tell(): void {
    const message = JSON.parse(this.simulation.snapshot()) as Message;
    if (message.type === "snapshot") this.listener.snapshot(message);
    for (let note = this.simulation.note(); note !== undefined; note = this.simulation.note()) {
      const said = JSON.parse(note) as Message;
      if (said.type === "note") this.listener.note(said.text);
    }
  }

  ask(ask: Ask): void {
    this.simulation.send(JSON.stringify(ask));
  }

  close(): void {
    this.simulation.free();
  }
}
