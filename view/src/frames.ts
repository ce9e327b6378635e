// The one place where North-East-Down becomes three's right-up-back; the same turn takes body FRD to a drawn body.

import { Quaternion, Vector3 } from "three";
import type { Quaternion as Wxyz, Vec3 } from "./types";

export function toScene([north, east, down]: Vec3): Vector3 {
  return new Vector3(east, -down, -north);
}

/** Of a body whose parts were placed by `toScene` from body axes. */
export function turnToScene([w, x, y, z]: Wxyz): Quaternion {
  const axis = toScene([x, y, z]);
  return new Quaternion(axis.x, axis.y, axis.z, w);
}

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];

export const degrees = (radians: number): number => (radians * 180) / Math.PI;
