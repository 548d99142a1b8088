// SPDX-License-Identifier: Apache-2.0
import {
  BoxGeometry,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PlaneGeometry,
} from "three";
import { isDark } from "./dom.ts";
import type { GroundMap } from "./ground_map.ts";
import { MachineModel } from "./machine_model.ts";
import { kGround, type Box, type Machine, type PoseMessage } from "./messages.ts";
import type { Place } from "./store.ts";

const kFootHeight_m = 0.08;
/// Height of the footprints above the highest ground under a foot, because the mesh between cells may be higher than
/// the cells.
const kPrintHeight_m = 0.008;

/// The machine in the 3D scene: its model, or its body parts as boxes if there is no model. Also draws the footprints
/// of its standing feet on the ground.
export class MachineView {
  readonly object = new Group(); ///< position in odom, relative to the zero of the scene
  readonly #element: HTMLElement;
  readonly #changed: () => void;
  readonly #body = new Group();
  readonly #prints = new Group();
  #machine: Machine | null | undefined;
  #model: MachineModel | undefined;

  /// Sets data-machine of the element to what is shown: none, boxes or model.
  constructor(element: HTMLElement, changed: () => void) {
    this.#element = element;
    this.#changed = changed;
    this.#prints.name = "footprint";
    this.object.add(this.#body, this.#prints);
  }

  draw(machine: Machine | null, pose: PoseMessage, place: Place, zero: Place, map: GroundMap): void {
    this.#take(machine);
    if (!machine) return;
    this.#model?.move(machine, pose.joints_rad);
    this.#body.position.set(place.x_m - zero.x_m, place.y_m - zero.y_m, pose.z_m);
    this.#body.quaternion.set(pose.qx, pose.qy, pose.qz, pose.qw);
    const floor_m = pose.z_m - machine.sole_depth_m;
    [machine.feet.left, machine.feet.right].forEach((foot, i) => {
      const { x_m, y_m } = carried(place, foot.center_x_m, foot.center_y_m);
      const print = this.#prints.children[i];
      const height_m = highestUnder(foot, place, map) ?? floor_m;
      print.position.set(x_m - zero.x_m, y_m - zero.y_m, height_m + kPrintHeight_m);
      print.rotation.z = place.yaw_rad;
    });
  }

  #take(machine: Machine | null): void {
    if (machine === this.#machine) return;
    this.#machine = machine;
    this.#model = undefined;
    this.#body.clear();
    this.#prints.clear();
    this.#element.dataset.machine = machine ? "boxes" : "none";
    if (!machine) return;
    this.#prints.add(printOf(machine.feet.left), printOf(machine.feet.right));
    this.#body.add(boxesOf(machine));
    if (machine.model) void this.#load(machine, machine.model);
  }

  /// Shows the boxes until the model is loaded. They stay if the model cannot be loaded.
  async #load(machine: Machine, path: string): Promise<void> {
    let model: MachineModel;
    try {
      const answer = await fetch(path);
      if (!answer.ok) return;
      model = new MachineModel(await answer.text());
    } catch {
      return;
    }
    if (this.#machine !== machine) return;
    this.#model = model;
    this.#body.clear();
    this.#body.add(model.object);
    this.#element.dataset.machine = "model";
    this.#changed();
  }
}

/// Returns the position in odom of a point that is given in base_link.
function carried(place: Place, x_m: number, y_m: number): { x_m: number; y_m: number } {
  const [c, s] = [Math.cos(place.yaw_rad), Math.sin(place.yaw_rad)];
  return { x_m: place.x_m + c * x_m - s * y_m, y_m: place.y_m + s * x_m + c * y_m };
}

/// Returns the height of the highest known ground under the corners and the middle of a foot, in odom [m]; undefined if
/// all this ground is unknown.
function highestUnder(foot: Box, place: Place, map: GroundMap): number | undefined {
  let highest_m: number | undefined;
  for (const [along, across] of [
    [0, 0],
    [0.5, 0.5],
    [0.5, -0.5],
    [-0.5, 0.5],
    [-0.5, -0.5],
  ]) {
    const { x_m, y_m } = carried(
      place,
      foot.center_x_m + along * foot.length_m,
      foot.center_y_m + across * foot.width_m,
    );
    const cell = map.cellAt(x_m, y_m);
    if (cell < 0 || map.ground(cell) === kGround.unknown) continue;
    const height_m = map.height_m(cell);
    if (!Number.isNaN(height_m)) highest_m = Math.max(highest_m ?? height_m, height_m);
  }
  return highest_m;
}

function printOf(foot: Box): Group {
  const shape = new PlaneGeometry(foot.length_m, foot.width_m);
  const color = 0x14171c;
  const fill = new MeshBasicMaterial({ color, transparent: true, opacity: 0.35, depthWrite: false });
  const print = new Group();
  print.add(
    new Mesh(shape, fill),
    new LineSegments(new EdgesGeometry(shape), new LineBasicMaterial({ color })),
  );
  return print;
}

function boxesOf(machine: Machine): Group {
  const glass = { color: 0x8fa3b8, transparent: true, opacity: 0.4, depthWrite: false };
  const body = new MeshLambertMaterial(glass);
  const foot = new MeshLambertMaterial({ color: 0xf5f7fa });
  const line = new LineBasicMaterial({ color: isDark() ? 0xe9eef4 : 0x14171c });
  const boxes = new Group();
  const add = (box: Box, low_m: number, high_m: number, material: MeshLambertMaterial) => {
    const shape = new BoxGeometry(box.length_m, box.width_m, high_m - low_m);
    for (const object of [new Mesh(shape, material), new LineSegments(new EdgesGeometry(shape), line)]) {
      object.position.set(box.center_x_m, box.center_y_m, (low_m + high_m) / 2 - machine.sole_depth_m);
      boxes.add(object);
    }
  };
  for (const part of machine.body) add(part, part.low_m, part.high_m, body);
  for (const one of [machine.feet.left, machine.feet.right]) add(one, 0, kFootHeight_m, foot);
  return boxes;
}
