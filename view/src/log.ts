// A ULog file as snapshots: the topics of docs/log.md.

import { MessageType, ULog } from "@foxglove/ulog";
import { BlobReader } from "@foxglove/ulog/web";
import firmware from "./firmware.json";
import type { OperatorText, Panel, Quaternion, Rotor, Snapshot, Vec3 } from "./types";

/** A message as the reader gives it. */
type Fields = Record<string, number | bigint | boolean | string | number[]>;

const TOPICS = [
  "vehicle_local_position", "vehicle_local_position_groundtruth", "vehicle_attitude", "vehicle_attitude_groundtruth",
  "tether_state", "tether_state_groundtruth", "battery_status", "actuator_motors", "vehicle_status",
] as const;
type TopicName = (typeof TOPICS)[number];

const ARMED = 2;
const ON_GROUND = 0;
const TEXTS = 8;

class Topic {
  readonly times: number[] = [];
  readonly values: Fields[] = [];

  /** The last one that is no later. */
  at(time: number): Fields | null {
    let [low, high] = [0, this.times.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((this.times[middle] ?? 0) <= time) low = middle + 1;
      else high = middle;
    }
    return this.values[low - 1] ?? null;
  }
}

const number = (of: Fields | null, name: string): number => Number(of?.[name] ?? 0);
const vector = (of: Fields | null, names: [string, string, string]): Vec3 => [number(of, names[0]), number(of, names[1]), number(of, names[2])];
const attitude = (of: Fields | null): Quaternion => {
  const q = of?.["q"] as number[] | undefined;
  return q && q.length === 4 ? [q[0] ?? 1, q[1] ?? 0, q[2] ?? 0, q[3] ?? 0] : [1, 0, 0, 0];
};

export class Log {
  readonly kind = "log";
  private readonly topics = new Map<TopicName, Topic>();
  private readonly texts: OperatorText[] = [];
  private rotors: Rotor[] = [];
  private hasWinch = false;
  duration = 0;

  private constructor(readonly name: string) {
    for (const topic of TOPICS) this.topics.set(topic, new Topic());
  }

  /** Reads all of it; an error is one line for whoever dropped the file. */
  static async open(file: File): Promise<Log> {
    const ulog = new ULog(new BlobReader(file));
    try {
      await ulog.open();
    } catch {
      throw new Error(`${file.name} is no ULog file`);
    }
    const log = new Log(file.name);
    const range = ulog.timeRange();
    if (!range) throw new Error(`${file.name}: nothing was logged`);
    const [began, ended] = range;
    const seconds = (at: bigint) => Number(at - began) * 1e-6;
    log.duration = seconds(ended);
    const parameter = (key: string) => Number(ulog.header?.parameters.get(key)?.value ?? 0);
    const arm = parameter("VEH_ARM") || 0.17;
    log.rotors = (firmware.frames[parameter("VEH_FRAME")] ?? firmware.frames[0] ?? []).map(
      (rotor) => ({ x_m: rotor.x * arm, y_m: rotor.y * arm, spin: rotor.spin }),
    );
    log.hasWinch = parameter("TET_KIND") === 1;
    const wanted = new Map<number, Topic>();
    for (const [id, { name }] of ulog.subscriptions) {
      const topic = log.topics.get(name as TopicName);
      if (topic) wanted.set(id, topic);
    }
    try {
      for await (const message of ulog.readMessages()) {
        if (message.type === MessageType.Data) {
          const topic = wanted.get(message.msgId);
          if (!topic) continue;
          topic.times.push(seconds(message.value.timestamp));
          topic.values.push(message.value as unknown as Fields);
        } else if (message.type === MessageType.Log) {
          log.texts.push({ time_s: seconds(message.timestamp), severity: Number(message.logLevel) & 7, text: message.message });
        }
      }
    } catch {
      // What stands before a damaged place is worth seeing.
    }
    if (log.topic("vehicle_attitude").times.length === 0) throw new Error(`${file.name} has no vehicle_attitude`);
    return log;
  }

  private topic(name: TopicName): Topic {
    return this.topics.get(name) ?? new Topic();
  }

  panel(): Panel {
    return {
      title: this.name, system: 0, takeoff_altitude_m: 0, rotors: this.rotors, mass_kg: 0, attachment_m: [0, 0, 0],
      has_winch: this.hasWinch, modes: [], faults: [], failsafes: [],
    };
  }

  /** The direction of the line's pull on the vehicle, NED; `null`: the log does not say. */
  pull(time: number): Vec3 | null {
    const tether = this.topic("tether_state_groundtruth").at(time);
    return tether && vector(tether, ["pull_x", "pull_y", "pull_z"]);
  }

  at(time: number): Snapshot {
    const at = (name: TopicName) => this.topic(name).at(time);
    const [status, battery, motors, place, tether] = [
      at("vehicle_status"), at("battery_status"), at("actuator_motors"), at("vehicle_local_position"), at("tether_state"),
    ];
    const failures = number(status, "failures");
    const [eph, epv] = [number(place, "eph"), number(place, "epv")];
    const nav = number(status, "nav_state");
    const throttle = (motors?.["control"] as number[] | undefined) ?? [];
    const begin = this.texts.findIndex((text) => text.time_s > time);
    const past = begin < 0 ? this.texts.length : begin;
    return {
      time_s: time,
      mode: firmware.modes.find((mode) => mode.nav_state === nav)?.name ?? "–",
      is_armed: number(status, "arming_state") === ARMED,
      is_armable: Boolean(status?.["pre_flight_checks_pass"]),
      is_in_air: number(status, "ground_state") !== ON_GROUND,
      commander: null,
      throttle: Array.from(throttle).slice(0, this.rotors.length).map((x) => (Number.isFinite(x) ? x : 0)),
      winch_tension_n: number(motors, "winch_tension"),
      truth: this.truth(time),
      estimate: {
        attitude: attitude(at("vehicle_attitude")),
        position_m: place?.["xy_valid"] ? vector(place, ["x", "y", "z"]) : null,
        // The log has both horizontal deviations as one.
        position_sd_m: [eph / Math.SQRT2, eph / Math.SQRT2, epv],
        height_m: number(place, "dist_bottom"),
        elevation_rad: tether && number(tether, "elevation"),
        azimuth_rad: tether && number(tether, "azimuth"),
        tension_n: tether && number(tether, "tension"),
      },
      battery: battery && { voltage_v: number(battery, "voltage_v"), remaining: number(battery, "remaining") },
      failures: firmware.failsafes.filter((_, bit) => (failures >>> bit) & 1),
      faults: [],
      texts: this.texts.slice(Math.max(0, past - TEXTS), past),
    };
  }

  private truth(time: number): Snapshot["truth"] {
    const place = this.topic("vehicle_local_position_groundtruth").at(time);
    if (!place) return null;
    const tether = this.topic("tether_state_groundtruth").at(time);
    const position_m = vector(place, ["x", "y", "z"]);
    return {
      position_m,
      velocity_mps: vector(place, ["vx", "vy", "vz"]),
      attitude: attitude(this.topic("vehicle_attitude_groundtruth").at(time)),
      anchor_m: [0, 0, 0],
      elevation_rad: number(tether, "elevation"),
      azimuth_rad: number(tether, "azimuth"),
      height_m: -position_m[2],
      tension_n: number(tether, "tension"),
      line_length_m: number(tether, "line"),
      line_m: tether ? [[0, 0, 0], position_m] : [],
      wind_mps: null,
    };
  }
}
