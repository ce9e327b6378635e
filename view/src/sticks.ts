// Keyboard and gamepad as sticks.

import type { Ask } from "./types";

/** So fast the throttle moves where it stays, 1/s. */
const THROTTLE_RATE = 0.5;
const FULL = 0.7;
/** Of a gamepad's stick around its middle. */
const DEAD = 0.08;

const KEYS: Record<string, ["pitch" | "roll" | "yaw" | "climb", number]> = {
  ArrowUp: ["pitch", 1], ArrowDown: ["pitch", -1], ArrowLeft: ["roll", -1], ArrowRight: ["roll", 1],
  KeyW: ["climb", 1], KeyS: ["climb", -1], KeyA: ["yaw", -1], KeyD: ["yaw", 1],
};

export class Sticks {
  isOn = false;
  private readonly held = new Set<string>();
  private throttle = 0;

  /** Whether the key is one of the sticks. */
  press(code: string): boolean {
    if (!(code in KEYS)) return false;
    this.held.add(code);
    return true;
  }

  release(code: string): void {
    this.held.delete(code);
  }

  rest(): void {
    this.held.clear();
  }

  /** Where they are now. In Stabilize the throttle stays where it is put; elsewhere it springs back to the middle, and
   * to the bottom while the motors stand. */
  read(mode: string, isArmed: boolean, seconds: number): Extract<Ask, { do: "sticks" }> {
    const by = { pitch: 0, roll: 0, yaw: 0, climb: 0 };
    for (const code of this.held) {
      const key = KEYS[code];
      if (key) by[key[0]] += key[1] * FULL;
    }
    const pad = navigator.getGamepads().find((one) => one?.connected && one.axes.length >= 4);
    if (pad) {
      const axis = (i: number) => {
        const x = pad.axes[i] ?? 0;
        return Math.abs(x) < DEAD ? 0 : x;
      };
      by.yaw += axis(0);
      by.climb -= axis(1);
      by.roll += axis(2);
      by.pitch -= axis(3);
    }
    if (!isArmed) this.throttle = 0;
    else if (mode === "Stabilize") this.throttle += by.climb * THROTTLE_RATE * seconds;
    else this.throttle = 0.5 + 0.5 * by.climb;
    this.throttle = clamp(this.throttle, 0, 1);
    const unit = (x: number) => clamp(x, -1, 1);
    return { do: "sticks", pitch: unit(by.pitch), roll: unit(by.roll), yaw: unit(by.yaw), throttle: this.throttle };
  }
}

const clamp = (x: number, least: number, most: number): number => Math.min(most, Math.max(least, x));
