// A row of the failsafe table, flown: up to a hold, something breaks, and where it ends.

import type { Flight } from "./flight";
import type { FailsafeRow, Snapshot } from "./types";

const CLIMB_SPEED = 50;
const WATCH_SPEED = 2;
/** In the hold before it breaks, and on the ground before it counts as the end, s. */
const HOLD = 4;
const REST = 1;
const LONGEST = 90;
/** Between two requests of the same, s. */
const AGAIN = 1;
/** Lower, the way down is measured no more, m. */
const NEAR = 0.35;

type Stage = "climb" | "hold" | "watch";

export class Trial {
  private stage: Stage = "climb";
  private since = 0;
  private askedAt = -AGAIN;
  private restingSince: number | null = null;
  private sink = 0;
  private modes: string[] = [];
  private wasSaid = false;

  constructor(
    private readonly flight: Flight,
    readonly row: FailsafeRow,
    private readonly say: (text: string) => void,
    private readonly pace: (speed: number) => void,
  ) {
    flight.restart();
    pace(CLIMB_SPEED);
    say("climbing");
  }

  /** After each step; true when it is over. */
  step(s: Snapshot): boolean {
    if (this.stage === "climb") return this.climb(s);
    if (this.stage === "hold") return this.hold(s);
    return this.watch(s);
  }

  private climb(s: Snapshot): boolean {
    if (s.is_in_air && s.mode === "Tether Hold") {
      this.stage = "hold";
      this.since = s.time_s;
      this.say("holding");
    } else if (s.time_s > this.askedAt + AGAIN) {
      this.askedAt = s.time_s;
      if (!s.is_armed && s.is_armable) this.flight.ask({ do: "arm" });
      else if (s.is_armed && s.mode !== "Takeoff") this.flight.ask({ do: "takeoff", altitude_m: 5 });
    }
    if (s.time_s < LONGEST) return false;
    this.say("never came to a hold");
    this.pace(1);
    return true;
  }

  private hold(s: Snapshot): boolean {
    const { trial } = this.row;
    if (!trial || s.time_s < this.since + HOLD) return false;
    this.flight.ask({ do: "fault", kind: trial.kind, value: trial.value, ...(trial.motor ? { motor: trial.motor } : {}) });
    this.stage = "watch";
    this.since = s.time_s;
    this.pace(WATCH_SPEED);
    this.say(`${trial.kind} …`);
    return false;
  }

  private watch(s: Snapshot): boolean {
    const after = s.time_s - this.since;
    this.wasSaid ||= s.failures.includes(this.row.text);
    if (s.is_armed && this.modes[this.modes.length - 1] !== s.mode) this.modes.push(s.mode);
    const truth = s.truth;
    if (truth && truth.height_m > NEAR) this.sink = truth.velocity_mps[2];
    const way = this.modes.join(" → ");
    this.say(`${way}, ${after.toFixed(0)} s`);
    if (s.is_armed) this.restingSince = null;
    else this.restingSince ??= s.time_s;
    const rests = this.restingSince !== null && s.time_s > this.restingSince + REST && (truth?.height_m ?? 0) < NEAR;
    if (!rests && after < LONGEST) return false;
    const end = rests ? `on the ground, down at ${Math.max(0, this.sink).toFixed(1)} m/s` : "flies on";
    this.say(`${way} → ${end} after ${after.toFixed(0)} s${this.wasSaid ? "" : "; another row came first"}`);
    this.pace(1);
    return true;
  }
}
