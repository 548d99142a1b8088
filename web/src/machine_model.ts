// SPDX-License-Identifier: Apache-2.0
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshPhongMaterial,
} from "three";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { Machine } from "./messages.ts";

/// The link whose frame is that of the left camera, with x along the view. A model may lack this link.
const kCameraLink = "camera";
/// Length of the camera symbol [m]; half width and half height of its end as shares of this length. The symbol is as
/// wide as the view of a common lens. It does not show the field of view of this camera.
const kView_m = 0.42;
const kHalfWidth = 0.55;
const kHalfHeight = 0.36;

/// The shape of a machine: the boxes of its URDF in base_link. Its joints move the boxes.
export class MachineModel {
  readonly object = new Group();
  readonly #robot: URDFRobot;

  /// Throws if the text is not a URDF.
  constructor(urdf: string) {
    this.#robot = new URDFLoader().parse(urdf);
    const line = new LineBasicMaterial({ color: 0x14171c });
    const seen = new Set<MeshPhongMaterial>();
    const meshes: Mesh[] = [];
    this.#robot.traverse((one) => one instanceof Mesh && meshes.push(one));
    for (const mesh of meshes) {
      if (mesh.material instanceof MeshPhongMaterial) seen.add(mesh.material);
      mesh.add(new LineSegments(new EdgesGeometry(mesh.geometry), line));
    }
    for (const material of seen) {
      // The file has sRGB colours, but the loader reads them as linear light. Without this conversion the colours
      // would look almost white.
      material.color.convertSRGBToLinear();
      material.specular = new Color(0x000000);
    }
    this.#robot.links[kCameraLink]?.add(viewMark());
    this.object.add(this.#robot);
  }

  /// Sets the joint angles of a pose, in the order of `machine.joints`. If their number differs from the number of
  /// joints, sets the angles of standing.
  move(machine: Machine, joints_rad: number[]): void {
    const known = joints_rad.length === machine.joints.length;
    machine.joints.forEach(({ name, stand_rad }, i) =>
      this.#robot.setJointValue(name, known ? joints_rad[i] : stand_rad),
    );
  }
}

/// Returns a pyramid from the camera along its view.
function viewMark(): Group {
  const [x, y, z] = [kView_m, kView_m * kHalfWidth, kView_m * kHalfHeight];
  const corners = [
    [x, y, z],
    [x, -y, z],
    [x, -y, -z],
    [x, y, -z],
  ];
  const faces: number[] = [];
  const edges: number[] = [];
  corners.forEach((corner, i) => {
    const next = corners[(i + 1) % corners.length];
    faces.push(0, 0, 0, ...corner, ...next);
    edges.push(0, 0, 0, ...corner, ...corner, ...next);
  });
  const geometry = (values: number[]) =>
    new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(values), 3));
  const color = 0xe69f00;
  const glass = new MeshBasicMaterial({
    color,
    side: DoubleSide,
    transparent: true,
    opacity: 0.16,
    depthWrite: false,
  });
  const mark = new Group();
  mark.name = "view";
  mark.add(
    new Mesh(geometry(faces), glass),
    new LineSegments(geometry(edges), new LineBasicMaterial({ color })),
  );
  return mark;
}
