// The vehicle as a drawing: arms, rotors that turn, body axes.

import {
  ArrowHelper, BoxGeometry, CircleGeometry, ConeGeometry, CylinderGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, Vector3,
} from "three";
import { toScene, turnToScene } from "./frames";
import type { Quaternion, Rotor, Vec3 } from "./types";

/** Drawn larger than it is: on a line of tens of metres it would be a speck. */
export const SCALE = 2.5;
/** Turns a second of a rotor at full throttle, as drawn: the real ones would only flicker. */
const TURNS = 7;

export class Vehicle {
  readonly group = new Group();
  private readonly axes = new Group();
  private readonly blades: { mesh: Mesh; disc: Mesh; spin: number }[] = [];

  constructor(rotors: Rotor[], color: string, opacity: number) {
    const solid = opacity === 1;
    const material = new MeshStandardMaterial({ color, opacity, transparent: !solid, depthWrite: solid, roughness: 0.6 });
    const dark = new MeshStandardMaterial({ color: "#2b3038", opacity, transparent: !solid, depthWrite: solid });
    const reach = Math.max(0.05, ...rotors.map((rotor) => Math.hypot(rotor.x_m, rotor.y_m)));
    const hull = new Mesh(new BoxGeometry(reach * 0.55, reach * 0.28, reach * 0.75), material);
    this.group.add(hull);
    const nose = new Mesh(new ConeGeometry(reach * 0.13, reach * 0.3, 16), dark);
    nose.position.copy(toScene([reach * 0.5, 0, 0]));
    nose.rotation.x = -Math.PI / 2;
    this.group.add(nose);
    for (const rotor of rotors) {
      const hub: Vec3 = [rotor.x_m, rotor.y_m, -reach * 0.12];
      const end = toScene(hub);
      const arm = new Mesh(new CylinderGeometry(reach * 0.05, reach * 0.05, end.length(), 8), dark);
      arm.position.copy(end.clone().multiplyScalar(0.5));
      arm.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), end.clone().normalize());
      this.group.add(arm);
      const span = reach * 0.5;
      const blade = new Mesh(new BoxGeometry(span * 2, reach * 0.02, reach * 0.08), material);
      blade.position.copy(end).y += reach * 0.08;
      const disc = new Mesh(
        new CircleGeometry(span, 32),
        new MeshBasicMaterial({ color, transparent: true, opacity: 0, side: DoubleSide, depthWrite: false }),
      );
      disc.rotation.x = -Math.PI / 2;
      disc.position.copy(blade.position);
      this.group.add(blade, disc);
      this.blades.push({ mesh: blade, disc, spin: rotor.spin });
    }
    if (solid) {
      const forward: [Vec3, number][] = [[[1, 0, 0], 0xe5484d], [[0, 1, 0], 0x30a46c], [[0, 0, 1], 0x3e63dd]];
      for (const [axis, tint] of forward) {
        this.axes.add(new ArrowHelper(toScene(axis), new Vector3(), reach * 2.2, tint, reach * 0.35, reach * 0.2));
      }
      this.group.add(this.axes);
    }
    this.group.scale.setScalar(SCALE);
  }

  showAxes(visible: boolean): void {
    this.axes.visible = visible;
  }

  place(position: Vec3, attitude: Quaternion): void {
    this.group.position.copy(toScene(position));
    this.group.quaternion.copy(turnToScene(attitude));
  }

  /** `seconds` pass with these throttles. */
  spin(throttle: number[], seconds: number): void {
    this.blades.forEach(({ mesh, disc, spin }, i) => {
      const share = throttle[i] ?? 0;
      // Its drag turns the nose the other way; seen from above a positive turn about up is to the left.
      mesh.rotation.y += spin * Math.sqrt(share) * TURNS * 2 * Math.PI * seconds;
      (disc.material as MeshBasicMaterial).opacity = 0.35 * share;
    });
  }
}
