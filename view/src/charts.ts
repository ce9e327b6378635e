// Strip charts: of the last minute while something flies, of the whole log otherwise.

import uPlot from "uplot";
import { degrees } from "./frames";
import type { Snapshot } from "./types";

const WINDOW = 60;
/** Between two points, s. */
const EVERY = 0.1;
/** Between two drawings, ms. */
const REFRESH = 200;

type Value = number | null;
interface Strip {
  title: string;
  unit: string;
  /** Least that the axis shows from bottom to top. */
  span: number;
  series: { name: string; kind: "truth" | "estimate" | "plain"; of: (s: Snapshot) => Value }[];
}

const angle = (x: number | null | undefined): Value => (x === null || x === undefined ? null : degrees(x));
const motor = (i: number) => ({
  name: `${i + 1}`,
  kind: "plain" as const,
  of: (s: Snapshot): Value => (s.throttle[i] === undefined ? null : 100 * s.throttle[i]),
});

const STRIPS: Strip[] = [
  { title: "Height", unit: "m", span: 1, series: [
    { name: "truth", kind: "truth", of: (s) => s.truth?.height_m ?? null },
    { name: "estimate", kind: "estimate", of: (s) => s.estimate.height_m },
  ] },
  { title: "Elevation", unit: "°", span: 5, series: [
    { name: "truth", kind: "truth", of: (s) => angle(s.truth?.elevation_rad) },
    { name: "estimate", kind: "estimate", of: (s) => angle(s.estimate.elevation_rad) },
  ] },
  { title: "Azimuth", unit: "°", span: 5, series: [
    { name: "truth", kind: "truth", of: (s) => angle(s.truth?.azimuth_rad) },
    { name: "estimate", kind: "estimate", of: (s) => angle(s.estimate.azimuth_rad) },
  ] },
  { title: "Tension", unit: "N", span: 4, series: [
    { name: "truth", kind: "truth", of: (s) => s.truth?.tension_n ?? null },
    { name: "estimate", kind: "estimate", of: (s) => s.estimate.tension_n },
  ] },
  { title: "Motors", unit: "%", span: 20, series: [0, 1, 2, 3, 4, 5, 6, 7].map(motor) },
  { title: "Battery", unit: "V", span: 0.4, series: [
    { name: "voltage", kind: "plain", of: (s) => s.battery?.voltage_v ?? null },
  ] },
  { title: "Wind", unit: "m/s", span: 2, series: [
    { name: "speed", kind: "plain", of: (s) => (s.truth?.wind_mps ? Math.hypot(...s.truth.wind_mps) : null) },
  ] },
];

export class Charts {
  private plots: { plot: uPlot; strip: Strip; rows: Value[][]; box: HTMLElement }[] = [];
  private times: number[] = [];
  private isWhole = false;
  private drawnAt = 0;

  constructor(private readonly place: HTMLElement, private readonly seek: (time: number) => void) {
    this.build();
    new ResizeObserver(() => this.fit()).observe(place);
  }

  /** Anew, in the colours of the page. */
  build(): void {
    const kept = this.plots.map(({ rows }) => rows);
    this.place.replaceChildren();
    const style = getComputedStyle(document.documentElement);
    const color = (name: string) => style.getPropertyValue(`--${name}`).trim();
    const hues = ["chart-1", "chart-2", "chart-3", "chart-4"];
    this.plots = STRIPS.map((strip, at) => {
      const box = document.createElement("figure");
      const caption = document.createElement("figcaption");
      caption.textContent = `${strip.title} [${strip.unit}]`;
      box.append(caption);
      this.place.append(box);
      const axis = { stroke: color("muted"), grid: { stroke: color("edge"), width: 1 }, ticks: { show: false }, font: "10px sans-serif" };
      const rows = kept[at] ?? strip.series.map(() => []);
      const plot = new uPlot({
        width: 200, height: 84, legend: { show: false }, cursor: { drag: { x: false, y: false }, points: { show: false } },
        padding: [4, 6, 0, 0],
        scales: { x: { time: false }, y: { range: (_, least, most) => range(least, most, strip.span) } },
        axes: [{ ...axis, size: 18, space: 40 }, { ...axis, size: 36, space: 22 }],
        series: [{}, ...strip.series.map((series, i) => ({
          label: series.name,
          stroke: series.kind === "truth" ? color("truth") : series.kind === "estimate" ? color("estimate") : color(hues[i % 4] ?? "chart-1"),
          width: series.kind === "truth" ? 2 : 1.3,
          points: { show: false },
        }))],
        hooks: { ready: [(u) => u.over.addEventListener("click", () => {
          const time = u.posToVal(u.cursor.left ?? 0, "x");
          if (this.isWhole) this.seek(time);
        })] },
      }, [this.times, ...rows] as uPlot.AlignedData, box);
      return { plot, strip, rows, box };
    });
    this.fit();
  }

  private fit(): void {
    for (const { plot, box } of this.plots) {
      const width = Math.max(80, box.clientWidth);
      const height = Math.max(60, box.clientHeight - 18);
      if (plot.width !== width || plot.height !== height) plot.setSize({ width, height });
    }
  }

  forget(): void {
    this.times.length = 0;
    this.isWhole = false;
    for (const { rows } of this.plots) for (const row of rows) row.length = 0;
    this.refresh();
  }

  /** Another instant of something that flies. */
  push(snapshot: Snapshot): void {
    const last = this.times[this.times.length - 1];
    if (last !== undefined && snapshot.time_s < last) this.forget();
    if (last !== undefined && snapshot.time_s < last + EVERY && snapshot.time_s >= last) return;
    this.append(snapshot);
    while ((this.times[0] ?? 0) < snapshot.time_s - WINDOW) {
      this.times.shift();
      for (const { rows } of this.plots) for (const row of rows) row.shift();
    }
    const now = performance.now();
    if (now < this.drawnAt + REFRESH) return;
    this.drawnAt = now;
    this.refresh();
  }

  /** A whole log. */
  fill(snapshots: Snapshot[]): void {
    this.forget();
    snapshots.forEach((snapshot) => this.append(snapshot));
    this.isWhole = true;
    this.refresh();
  }

  /** A mark at the instant that the scene shows. */
  mark(time: number): void {
    for (const { plot } of this.plots) {
      const left = plot.valToPos(time, "x");
      if (Number.isFinite(left)) plot.setCursor({ left, top: -10 }, false);
    }
  }

  private append(snapshot: Snapshot): void {
    this.times.push(snapshot.time_s);
    for (const { strip, rows } of this.plots) strip.series.forEach((series, i) => rows[i]?.push(series.of(snapshot)));
  }

  private refresh(): void {
    for (const { plot, rows } of this.plots) plot.setData([this.times, ...rows] as uPlot.AlignedData);
  }
}

/** Of an axis: what there is, with a margin, and no less than a span. */
function range(least: number | null, most: number | null, span: number): [number, number] {
  const [low, high] = [least ?? 0, most ?? 0];
  const [middle, half] = [(low + high) / 2, Math.max(span, 1.15 * (high - low)) / 2];
  return [middle - half, middle + half];
}
