// SPDX-License-Identifier: GPL-3.0-or-later
//
// What hands hold: the force on them, and the tool of a device.
import * as THREE from './three/build/three.module.js';

// They are often inside the body.
function show_through(object) {
  object.traverse((part) => {
    part.renderOrder = 1;
    part.frustumCulled = false;
    if (part.material) Object.assign(part.material, { depthTest: false, transparent: true });
  });
  object.visible = false;
  return object;
}

// An arrow whose length is the force as a part of the largest that there was.
export class Force {
  constructor(scene, colour) {
    this.arrow = show_through(new THREE.ArrowHelper(new THREE.Vector3(0, 1, 0), new THREE.Vector3(), 1, colour));
    this.largest = 0;
    scene.add(this.arrow);
  }

  // `held`: {force}, or null; `longest`: the length of the largest.
  show(held, place, longest) {
    this.arrow.visible = Boolean(held);
    if (!held) this.largest = 0;
    if (!held) return;
    const force = new THREE.Vector3(...held.force), size = force.length();
    this.largest = Math.max(this.largest, size);
    this.arrow.visible = size > 0;
    if (size === 0) return;
    this.arrow.position.copy(place);
    this.arrow.setDirection(force.normalize());
    this.arrow.setLength(Math.max(longest * size / this.largest, 2e-3 * longest));
  }
}

// A pen whose tip is at the pose of a device.
export class Pen {
  constructor(scene, colour) {
    const look = new THREE.MeshPhongMaterial({ color: colour });
    const tip = new THREE.Mesh(new THREE.ConeGeometry(0.12, 0.4, 16), look);
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.12, 0.12, 1, 16), look);
    tip.rotation.x = Math.PI;  // from its base up to its tip down
    tip.position.y = 0.2;
    shaft.position.y = 0.9;
    this.pen = show_through(new THREE.Group().add(tip, shaft));
    scene.add(this.pen);
  }

  // `rotation`: vector, rad; the pen points down at rest.
  show(device, place, up, length) {
    this.pen.visible = Boolean(device);
    if (!device) return;
    const turn = new THREE.Vector3(...device.rotation), angle = turn.length();
    this.pen.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), up);
    if (angle > 0) this.pen.quaternion.premultiply(new THREE.Quaternion().setFromAxisAngle(turn.normalize(), angle));
    this.pen.position.copy(place);
    this.pen.scale.setScalar(length);
  }
}
