// The messages of sitl/src/view; units stand in the names, axes are NED and FRD.

export type Vec3 = [number, number, number];
/** `[w, x, y, z]`, body to world. */
export type Quaternion = [number, number, number, number];

export interface Truth {
  position_m: Vec3;
  velocity_mps: Vec3;
  attitude: Quaternion;
  anchor_m: Vec3;
  elevation_rad: number;
  azimuth_rad: number;
  height_m: number;
  tension_n: number;
  line_length_m: number;
  line_m: Vec3[];
  wind_mps: Vec3 | null;
}

export interface Estimate {
  attitude: Quaternion;
  position_m: Vec3 | null;
  position_sd_m: Vec3;
  height_m: number;
  elevation_rad: number | null;
  azimuth_rad: number | null;
  tension_n: number | null;
}

export interface OperatorText {
  time_s: number;
  severity: number;
  text: string;
}

export interface Snapshot {
  time_s: number;
  mode: string;
  is_armed: boolean;
  is_armable: boolean;
  is_in_air: boolean;
  commander: number | null;
  throttle: number[];
  winch_tension_n: number;
  truth: Truth | null;
  estimate: Estimate;
  battery: { voltage_v: number; remaining: number } | null;
  failures: string[];
  faults: string[];
  texts: OperatorText[];
}

export interface Rotor {
  x_m: number;
  y_m: number;
  spin: number;
}

export interface FaultButton {
  kind: string;
  unit: string | null;
  least: number;
  most: number;
  doc: string;
}

export interface Trial {
  kind: string;
  value: number;
  motor: number | null;
}

export interface FailsafeRow {
  text: string;
  action: string;
  delay_s: number;
  trial: Trial | null;
}

export interface Panel {
  title: string;
  system: number;
  takeoff_altitude_m: number;
  rotors: Rotor[];
  mass_kg: number;
  attachment_m: Vec3;
  has_winch: boolean;
  modes: { name: string; by_sticks: boolean }[];
  faults: FaultButton[];
  failsafes: FailsafeRow[];
}

export type Ask =
  | { do: "beat" | "arm" | "disarm" | "terminate" }
  | { do: "takeoff"; altitude_m: number }
  | { do: "mode"; name: string }
  | { do: "move"; elevation_rad?: number; azimuth_rad?: number; length_m?: number; tension_n?: number }
  | { do: "sticks"; pitch: number; roll: number; throttle: number; yaw: number }
  | { do: "fault"; kind: string; value?: number; motor?: number }
  | { do: "clear"; kind?: string };

export type Message =
  | ({ type: "panel" } & Panel)
  | ({ type: "snapshot" } & Snapshot)
  | { type: "note"; text: string };

/** Where snapshots come from: a server, a flight in this page, a log. */
export interface Source {
  readonly kind: "live" | "wasm" | "log";
  ask(ask: Ask): void;
  close(): void;
}

export interface Listener {
  panel(panel: Panel): void;
  snapshot(snapshot: Snapshot): void;
  note(text: string): void;
}
