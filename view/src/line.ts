// The line through the points that are known; between two of them it hangs as far as its length lets it.

import { toScene } from "./frames";
import type { Vec3 } from "./types";
import { Vector3 } from "three";

const POINTS = 24;
/** A straight line that is longer than its ends are apart by less than this is straight, m. */
const STRAIGHT = 0.02;

export function drawn(nodes: Vec3[], length: number, pull: Vec3 | null): Vector3[] {
  const [from, to] = nodes;
  if (!from || !to || nodes.length > 2) return nodes.map(toScene);
  const [a, b] = [toScene(from), toScene(to)];
  const apart = a.distanceTo(b);
  if (pull && Math.hypot(...pull) > 0.5) {
    // A log has the direction at the vehicle's end: a parabola with that tangent.
    const turn = b.clone().add(toScene(pull).multiplyScalar(apart / 2));
    return along((t) => a.clone().multiplyScalar((1 - t) * (1 - t)).addScaledVector(turn, 2 * t * (1 - t)).addScaledVector(b, t * t));
  }
  if (length < apart + STRAIGHT) return [a, b];
  // The sag of a flat parabola of that length.
  const sag = Math.sqrt((3 / 8) * apart * (length - apart));
  return along((t) => {
    const point = a.clone().lerp(b, t);
    point.y = Math.max(Math.min(a.y, b.y, 0.01), point.y - 4 * sag * t * (1 - t));
    return point;
  });
}

function along(at: (t: number) => Vector3): Vector3[] {
  return Array.from({ length: POINTS + 1 }, (_, i) => at(i / POINTS));
}
