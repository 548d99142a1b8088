// SPDX-License-Identifier: Apache-2.0
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  DirectionalLight,
  DoubleSide,
  LineBasicMaterial,
  LineLoop,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  Vector3,
  WebGLRenderer,
} from "three";
import { isDark, make } from "./dom.ts";
import type { GroundMap } from "./ground_map.ts";
import { kCell_px, kDarkColors, kLightColors, paintGround, type GroundWindow } from "./ground_picture.ts";
import { MachineView } from "./machine_view.ts";
import { kGround } from "./messages.ts";
import type { Place, Store } from "./store.ts";

/// Largest number of cells along the side of the mesh: 6 m with cells of 25 mm. Of a larger map, only the part around
/// the machine is shown.
const kMostCells = 240;
/// Shortest time between two pictures. A software renderer draws only a few pictures per second.
const kPeriod_ms = 60;
const kBorderPoints = 96;
/// Height of the border over the attested ground, so that the ground does not hide the border.
const kBorderHeight_m = 0.01;

/// The ground as a lit mesh with the machine on it. x and y are in odom relative to `#zero`, z is in odom. Unknown
/// ground is a hole. style.css makes the picture grey when its data are old.
export class Scene3d {
  readonly #store: Store;
  readonly #element: HTMLElement;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(45, 1, 0.05, 100);
  readonly #picture = make("canvas");
  readonly #texture = new CanvasTexture(this.#picture);
  readonly #ground = new Mesh(
    new BufferGeometry(),
    new MeshLambertMaterial({ map: this.#texture, side: DoubleSide }),
  );
  readonly #drops = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({ color: 0xd55e00, side: DoubleSide, transparent: true, opacity: 0.75 }),
  );
  readonly #rims = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: 0x14171c }));
  readonly #border = new LineLoop(new BufferGeometry(), new LineBasicMaterial());
  readonly #machine: MachineView;
  #zero: Place | undefined;
  #view = { azimuth_rad: Math.PI + 0.85, elevation_rad: 0.72, distance_m: 3.9 };
  #drawn_at_ms = 0;
  #painted = "";

  /// Throws if the browser has no WebGL.
  constructor(element: HTMLElement, store: Store, changed: () => void) {
    this.#element = element;
    this.#store = store;
    this.#machine = new MachineView(element, changed);
    this.#renderer = new WebGLRenderer({ antialias: true });
    const canvas = this.#renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute(
      "aria-label",
      "The ground and the machine in three dimensions; arrow keys turn the view",
    );
    element.append(canvas);
    this.#texture.colorSpace = SRGBColorSpace;
    this.#texture.generateMipmaps = true;
    this.#texture.anisotropy = 8;
    this.#camera.up.set(0, 0, 1);
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(-2, 3, 4);
    this.#scene.add(
      new AmbientLight(0xffffff, 1.7),
      sun,
      this.#ground,
      this.#drops,
      this.#rims,
      this.#border,
      this.#machine.object,
    );
    this.#ground.frustumCulled = this.#drops.frustumCulled = this.#rims.frustumCulled = false;
    this.#border.frustumCulled = false;
    this.#border.name = "attested";
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons !== 1) return;
      this.#turn(-event.movementX * 0.008, event.movementY * 0.006);
      changed();
    });
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(event.deltaY > 0 ? 1 : -1);
        changed();
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
      const turn = {
        ArrowLeft: [-0.15, 0],
        ArrowRight: [0.15, 0],
        ArrowUp: [0, 0.1],
        ArrowDown: [0, -0.1],
      }[event.key];
      if (!turn) return;
      event.preventDefault();
      this.#turn(turn[0], turn[1]);
      changed();
    });
  }

  zoom(by: -1 | 1): void {
    this.#view.distance_m = Math.max(1.5, Math.min(12, this.#view.distance_m * 1.25 ** by));
  }

  draw(): void {
    const now_ms = performance.now();
    if (now_ms - this.#drawn_at_ms < kPeriod_ms) return;
    const { place, pose, map, hello } = this.#store;
    const width = this.#element.clientWidth;
    const height = this.#element.clientHeight;
    if (width === 0 || height === 0) return;
    this.#drawn_at_ms = now_ms;
    this.#scene.background = new Color(isDark() ? 0x1e2127 : 0xced3db);
    if (place && pose) {
      this.#zero ??= place;
      const zero = this.#zero;
      if (map.nx > 0) this.#drawGround(map, place, zero);
      this.#machine.draw(hello?.machine ?? null, pose, place, zero, map);
      const floor_m = pose.z_m - (hello?.machine?.sole_depth_m ?? 1);
      this.#look(new Vector3(place.x_m - zero.x_m, place.y_m - zero.y_m, floor_m + 0.45), place.yaw_rad);
    }
    const ratio = Math.min(1.5, devicePixelRatio || 1);
    if (this.#renderer.getPixelRatio() !== ratio) this.#renderer.setPixelRatio(ratio);
    const canvas = this.#renderer.domElement;
    if (
      canvas.clientWidth !== width ||
      canvas.clientHeight !== height ||
      canvas.width !== Math.floor(width * ratio)
    )
      this.#renderer.setSize(width, height);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#renderer.render(this.#scene, this.#camera);
  }

  #turn(azimuth_rad: number, elevation_rad: number): void {
    this.#view.azimuth_rad += azimuth_rad;
    this.#view.elevation_rad = Math.max(0.08, Math.min(1.5, this.#view.elevation_rad + elevation_rad));
  }

  /// Points the camera at the machine. The direction of view turns with the machine. At first it is from behind and
  /// from the right.
  #look(target: Vector3, yaw_rad: number): void {
    const { azimuth_rad, elevation_rad, distance_m } = this.#view;
    const across_m = distance_m * Math.cos(elevation_rad);
    this.#camera.position.set(
      target.x + across_m * Math.cos(yaw_rad + azimuth_rad),
      target.y + across_m * Math.sin(yaw_rad + azimuth_rad),
      target.z + distance_m * Math.sin(elevation_rad),
    );
    // Shows more ground ahead of the machine than behind it.
    this.#camera.lookAt(target.x + 0.5 * Math.cos(yaw_rad), target.y + 0.5 * Math.sin(yaw_rad), target.z);
  }

  #drawGround(map: GroundMap, place: Place, zero: Place): void {
    const cells = Math.min(kMostCells, Math.max(map.nx, map.ny));
    const first = (at_m: number, origin_m: number, count: number) =>
      Math.max(0, Math.min(count - cells, Math.floor((at_m - origin_m) / map.resolution_m) - (cells >> 1)));
    const window: GroundWindow = {
      first_ix: first(place.x_m, map.origin_x_m, map.nx),
      first_iy: first(place.y_m, map.origin_y_m, map.ny),
      cells,
    };
    const { attested } = this.#store;
    const key = [
      map.version,
      map.frame_time_ns,
      ...Object.values(window),
      isDark(),
      ...Object.values(attested ?? {}),
    ].join();
    if (key === this.#painted) return;
    this.#painted = key;
    const side_px = cells * kCell_px;
    const resized = this.#picture.width !== side_px;
    if (resized) this.#picture.width = this.#picture.height = side_px;
    if (resized) this.#texture.dispose();
    const image = new ImageData(side_px, side_px);
    const colors = isDark() ? kDarkColors : kLightColors;
    paintGround(map, window, colors, new Uint32Array(image.data.buffer), attested);
    this.#picture.getContext("2d")!.putImageData(image, 0, 0);
    this.#texture.needsUpdate = true;
    this.#ground.geometry.dispose();
    this.#ground.geometry = groundMesh(map, window, zero);
    this.#drawEdges(map, zero);
    this.#drawAttested(zero);
  }

  /// Draws the border of the attested area, also over the holes of unknown ground.
  #drawAttested(zero: Place): void {
    const { attested } = this.#store;
    const points: number[] = [];
    for (let i = 0; attested && i < kBorderPoints; ++i) {
      const angle_rad = (2 * Math.PI * i) / kBorderPoints;
      points.push(
        attested.x_m - zero.x_m + attested.radius_m * Math.cos(angle_rad),
        attested.y_m - zero.y_m + attested.radius_m * Math.sin(angle_rad),
        attested.z_m + kBorderHeight_m,
      );
    }
    this.#border.material.color.set(isDark() ? 0x56b4e9 : 0x0072b2);
    this.#border.geometry.dispose();
    this.#border.geometry = new BufferGeometry().setAttribute(
      "position",
      new BufferAttribute(new Float32Array(points), 3),
    );
  }

  /// Draws each drop as a curtain from its upper to its lower ground.
  #drawEdges(map: GroundMap, zero: Place): void {
    const corners: number[] = [];
    const rims: number[] = [];
    const x0_m = map.origin_x_m - zero.x_m;
    const y0_m = map.origin_y_m - zero.y_m;
    for (const edge of map.edges) {
      const [ax, ay] = [x0_m + edge.from_x_tenth_mm * 1e-4, y0_m + edge.from_y_tenth_mm * 1e-4];
      const [bx, by] = [x0_m + edge.to_x_tenth_mm * 1e-4, y0_m + edge.to_y_tenth_mm * 1e-4];
      const [up, down] = [edge.upper_tenth_mm * 1e-4 + 0.005, edge.lower_tenth_mm * 1e-4];
      corners.push(ax, ay, up, bx, by, up, bx, by, down, ax, ay, up, bx, by, down, ax, ay, down);
      rims.push(ax, ay, up, bx, by, up);
    }
    for (const [object, values] of [
      [this.#drops, corners],
      [this.#rims, rims],
    ] as const) {
      object.geometry.dispose();
      object.geometry = new BufferGeometry().setAttribute(
        "position",
        new BufferAttribute(new Float32Array(values), 3),
      );
    }
  }
}

/// Returns the mesh of the ground. Its corners are the middles of cells. A face exists only where all its four cells
/// are known.
export function groundMesh(map: GroundMap, window: GroundWindow, zero: Place): BufferGeometry {
  const { first_ix, first_iy, cells } = window;
  const positions = new Float32Array(3 * cells * cells);
  const uvs = new Float32Array(2 * cells * cells);
  const known = new Uint8Array(cells * cells);
  for (let row = 0, i = 0; row < cells; ++row)
    for (let column = 0; column < cells; ++column, ++i) {
      const ix = first_ix + column;
      const iy = first_iy + row;
      positions[3 * i] = map.origin_x_m + (ix + 0.5) * map.resolution_m - zero.x_m;
      positions[3 * i + 1] = map.origin_y_m + (iy + 0.5) * map.resolution_m - zero.y_m;
      uvs[2 * i] = (column + 0.5) / cells;
      uvs[2 * i + 1] = (row + 0.5) / cells;
      if (ix >= map.nx || iy >= map.ny) continue;
      const cell = iy * map.nx + ix;
      const height_m = map.height_m(cell);
      known[i] = map.ground(cell) !== kGround.unknown && !Number.isNaN(height_m) ? 1 : 0;
      positions[3 * i + 2] = known[i] ? height_m : 0;
    }
  const faces: number[] = [];
  for (let row = 0; row + 1 < cells; ++row)
    for (let column = 0; column + 1 < cells; ++column) {
      const a = row * cells + column,
        b = a + 1,
        c = a + cells,
        d = c + 1;
      if (known[a] && known[b] && known[c] && known[d]) faces.push(a, b, d, a, d, c);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("uv", new BufferAttribute(uvs, 2));
  geometry.setIndex(new BufferAttribute(new Uint32Array(faces), 1));
  geometry.computeVertexNormals();
  return geometry;
}
