// Time in a log: slider, play, keys.

import type { Charts } from "./charts";
import type { Log } from "./log";
import { element } from "./page";
import type { Snapshot, Vec3 } from "./types";

/** Points of a chart. */
const POINTS = 1500;

export class Player {
  private time = 0;
  private isPlaying = false;

  constructor(
    readonly log: Log,
    private readonly charts: Charts,
    private readonly show: (snapshot: Snapshot, pull: Vec3 | null) => void,
  ) {
    const step = Math.max(0.05, log.duration / POINTS);
    charts.fill(Array.from({ length: Math.ceil(log.duration / step) }, (_, i) => log.at(i * step)));
    const slider = element<HTMLInputElement>("slider");
    slider.max = String(log.duration);
    slider.oninput = () => this.seek(Number(slider.value));
    element("play").onclick = () => this.toggle();
    element("scrub").hidden = false;
    this.play(false);
    this.seek(0);
  }

  toggle(): void {
    if (!this.isPlaying && this.time >= this.log.duration) this.seek(0);
    this.play(!this.isPlaying);
  }

  private play(is: boolean): void {
    this.isPlaying = is;
    element("play").textContent = is ? "❚❚" : "▶";
  }

  seek(time: number): void {
    this.time = Math.min(this.log.duration, Math.max(0, time));
    element<HTMLInputElement>("slider").value = String(this.time);
    element("scrub-time").textContent = `${this.time.toFixed(1)} / ${this.log.duration.toFixed(1)} s`;
    this.show(this.log.at(this.time), this.log.pull(this.time));
    this.charts.mark(this.time);
  }

  /** Whether the key was one of its own. */
  press(event: KeyboardEvent): boolean {
    const step = event.shiftKey ? 10 : 1;
    if (event.code === "Space") this.toggle();
    else if (event.code === "ArrowLeft") this.seek(this.time - step);
    else if (event.code === "ArrowRight") this.seek(this.time + step);
    else if (event.code === "Home") this.seek(0);
    else if (event.code === "End") this.seek(this.log.duration);
    else return false;
    return true;
  }

  advance(seconds: number): void {
    if (!this.isPlaying) return;
    this.seek(this.time + seconds);
    if (this.time >= this.log.duration) this.play(false);
  }

  close(): void {
    element("scrub").hidden = true;
  }
}
