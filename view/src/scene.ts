// The world in three dimensions.

import {
  AmbientLight, ArrowHelper, BufferGeometry, CanvasTexture, Color, CylinderGeometry, DirectionalLight, GridHelper, Line,
  LineBasicMaterial, Mesh, MeshBasicMaterial, MeshStandardMaterial, PerspectiveCamera, Scene, SphereGeometry, Sprite,
  SpriteMaterial, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { add, toScene, turnToScene } from "./frames";
import { drawn } from "./line";
import type { Panel, Quaternion, Snapshot, Vec3 } from "./types";
import { Vehicle } from "./vehicle";

const TRAIL = 1500;
/** Between two points of the trail, s. */
const TRAIL_EVERY = 0.1;
/** Standard deviations that the ellipsoid shows. */
const DEVIATIONS = 2;
/** Of the camera from the middle of a line without length, m. */
const NEAREST = 5;
/** Between two frames, s, on a machine for which it is too much. */
const SLOW = 0.08;
const COLORS = {
  light: { sky: "#eef2f6", grid: 0xb8c2cc, middle: 0x8896a5, line: 0x30363d },
  dark: { sky: "#12161b", grid: 0x2c343d, middle: 0x4a5663, line: 0xdfe6ee },
};
const LEVEL: Quaternion = [1, 0, 0, 0];

export class World {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(45, 1, 0.1, 2000);
  private readonly orbit: OrbitControls;
  private grid = new GridHelper();
  private readonly winch: Mesh;
  private readonly line: Line;
  private readonly trail: Line;
  private readonly trailPoints: Vector3[] = [];
  private trailTime = -1;
  private readonly wind = new ArrowHelper(new Vector3(1, 0, 0), new Vector3(), 1, 0x0091ff, 0.5, 0.3);
  private readonly ellipsoid: Mesh;
  private vehicle = new Vehicle([], "#f76b15", 1);
  private ghost = new Vehicle([], "#8e4ec6", 0.45);
  private throttle: number[] = [];
  private followed = new Vector3();
  private axes = true;
  private isHeld = false;
  private interval = 0;
  private sharpness = 1;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.maxPolarAngle = Math.PI * 0.495;
    this.orbit.minDistance = 1;
    this.orbit.maxDistance = 500;
    this.canvas.addEventListener("wheel", () => (this.isHeld = true), { passive: true });
    this.canvas.addEventListener("touchstart", () => (this.isHeld = true), { passive: true });
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(8, 20, 6);
    this.scene.add(new AmbientLight(0xffffff, 1.4), sun);
    this.winch = new Mesh(new CylinderGeometry(0.13, 0.13, 0.3, 24), new MeshStandardMaterial({ color: "#7d8894" }));
    this.winch.rotation.z = Math.PI / 2;
    this.line = new Line(new BufferGeometry(), new LineBasicMaterial());
    this.trail = new Line(new BufferGeometry(), new LineBasicMaterial({ color: 0xf76b15, transparent: true, opacity: 0.55 }));
    this.ellipsoid = new Mesh(
      new SphereGeometry(1, 32, 20),
      new MeshBasicMaterial({ color: "#8e4ec6", transparent: true, opacity: 0.18, depthWrite: false }),
    );
    for (const drawing of [this.line, this.trail]) drawing.frustumCulled = false;
    this.scene.add(this.winch, this.line, this.trail, this.wind, this.ellipsoid, letter("N", [11, 0, 0]));
    this.scene.add(this.vehicle.group, this.ghost.group);
    this.recolor(false);
    this.look();
  }

  /** The vehicle that the panel describes, and no trail. */
  begin(panel: Panel): void {
    this.scene.remove(this.vehicle.group, this.ghost.group);
    this.vehicle = new Vehicle(panel.rotors, "#f76b15", 1);
    this.ghost = new Vehicle(panel.rotors, "#8e4ec6", 0.45);
    this.vehicle.showAxes(this.axes);
    this.scene.add(this.vehicle.group, this.ghost.group);
    this.winch.visible = true;
    this.winch.scale.setScalar(panel.has_winch ? 1 : 0.5);
    this.forget();
  }

  /** The way so far. */
  forget(): void {
    this.trailPoints.length = 0;
    this.trailTime = -1;
    this.trail.geometry.setFromPoints([]);
  }

  /** Where it all began to be looked at. */
  look(): void {
    this.isHeld = false;
    this.camera.position.set(-5, 4.5, 8);
    this.orbit.target.set(0, 1.2, -2);
    this.followed.set(0, 1.2, -2);
    this.orbit.update();
  }

  toggleAxes(): void {
    this.axes = !this.axes;
    this.vehicle.showAxes(this.axes);
  }

  recolor(isDark: boolean): void {
    const colors = isDark ? COLORS.dark : COLORS.light;
    this.scene.background = new Color(colors.sky);
    this.scene.remove(this.grid);
    this.grid.dispose();
    this.grid = new GridHelper(60, 60, colors.middle, colors.grid);
    this.scene.add(this.grid);
    (this.line.material as LineBasicMaterial).color.set(colors.line);
  }

  show(snapshot: Snapshot, pull: Vec3 | null): void {
    const { truth, estimate } = snapshot;
    this.throttle = snapshot.throttle;
    const anchor: Vec3 = truth?.anchor_m ?? [0, 0, 0];
    const believed = estimate.position_m && add(anchor, estimate.position_m);
    const place: Vec3 = truth?.position_m ?? believed ?? [0, 0, -estimate.height_m];
    this.vehicle.place(place, truth?.attitude ?? estimate.attitude);
    this.ghost.group.visible = truth !== null && believed !== null;
    this.ellipsoid.visible = believed !== null;
    if (believed) {
      this.ghost.place(believed, estimate.attitude);
      const [north, east, down] = estimate.position_sd_m;
      this.ellipsoid.position.copy(toScene(believed));
      this.ellipsoid.quaternion.copy(turnToScene(LEVEL));
      const size = (x: number) => Math.max(0.01, DEVIATIONS * x);
      this.ellipsoid.scale.set(size(east), size(down), size(north));
    }
    this.winch.position.copy(toScene(anchor));
    this.line.geometry.dispose();
    this.line.geometry = new BufferGeometry().setFromPoints(drawn(truth?.line_m ?? [], truth?.line_length_m ?? 0, pull));
    this.blow(truth?.wind_mps ?? null, toScene(place));
    this.leave(snapshot.time_s, toScene(place));
    this.follow(toScene(anchor), toScene(place));
  }

  private blow(wind: Vec3 | null, at: Vector3): void {
    const speed = wind ? Math.hypot(...wind) : 0;
    this.wind.visible = speed > 0.1;
    if (!wind || speed <= 0.1) return;
    const towards = toScene(wind).normalize();
    const length = 0.35 * speed + 0.4;
    this.wind.setDirection(towards);
    this.wind.setLength(length, 0.35, 0.2);
    // Upwind of the vehicle, its head before it.
    this.wind.position.copy(at).addScaledVector(towards, -length - 0.8);
  }

  private leave(time: number, place: Vector3): void {
    if (time < this.trailTime) this.forget();
    if (time < this.trailTime + TRAIL_EVERY && this.trailTime >= 0) return;
    this.trailTime = time;
    this.trailPoints.push(place);
    if (this.trailPoints.length > TRAIL) this.trailPoints.shift();
    this.trail.geometry.dispose();
    this.trail.geometry = new BufferGeometry().setFromPoints(this.trailPoints);
  }

  /** Anchor and vehicle stay in the picture, from wherever somebody looks; how far away is theirs once they have said. */
  private follow(anchor: Vector3, place: Vector3): void {
    if (!this.isHeld) {
      const away = this.camera.position.clone().sub(this.orbit.target);
      const wanted = NEAREST + 1.5 * anchor.distanceTo(place);
      away.multiplyScalar(1 + 0.05 * (wanted / away.length() - 1));
      this.camera.position.copy(this.orbit.target).add(away);
    }
    const middle = anchor.clone().lerp(place, 0.5);
    const moved = middle.clone().sub(this.followed).multiplyScalar(0.08);
    this.followed.add(moved);
    this.orbit.target.add(moved);
    this.camera.position.add(moved);
  }

  /** A frame; `seconds` since the last one. */
  draw(seconds: number): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.interval += 0.1 * (Math.min(seconds, 0.5) - this.interval);
    if (this.interval > SLOW) {
      // Without a graphics processor it is the number of pixels that takes the time.
      this.sharpness = Math.max(0.4, this.sharpness * 0.7);
      this.interval = 0;
    }
    const ratio = Math.min(window.devicePixelRatio, 2) * this.sharpness;
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(1, height);
      this.camera.updateProjectionMatrix();
    }
    this.vehicle.spin(this.throttle, seconds);
    this.ghost.spin(this.throttle, seconds);
    this.orbit.update();
    this.renderer.render(this.scene, this.camera);
  }
}

function letter(text: string, at: Vec3): Sprite {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  if (pen) {
    pen.font = "bold 48px sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillStyle = "#d6409f";
    pen.fillText(text, 32, 34);
  }
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), transparent: true }));
  sprite.position.copy(toScene(at));
  return sprite;
}
