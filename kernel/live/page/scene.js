// SPDX-License-Identifier: GPL-3.0-or-later
//
// The picture: body, edges, obstacles and camera, drawn when something has changed.
import * as THREE from './three/build/three.module.js';
import { Force, Pen } from './held.js';
import { body_material, is_drawn_by_software, no_value, shared_uniforms } from './look.js';

// Shorter edges of elements only darken the picture, pixels.
const shortest_edge = 4;

// Of faces with 3 or 4 corners.
function triangles_of(corners, size) {
  if (size === 3) return corners;
  const triangles = new Uint32Array(corners.length / 4 * 6);
  for (let i = 0, at = 0; i < corners.length; i += 4)
    for (const k of [0, 1, 2, 0, 2, 3]) triangles[at++] = corners[i + k];
  return triangles;
}

// Each edge of a closed surface belongs to two faces, which run along it in opposite directions.
function edges_of(corners, size) {
  const edges = [];
  for (let i = 0; i < corners.length; ++i) {
    const next = (i + 1) % size === 0 ? i + 1 - size : i + 1;
    if (corners[i] < corners[next]) edges.push(corners[i], corners[next]);
  }
  return new Uint32Array(edges);
}

export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !is_drawn_by_software(),
      preserveDrawingBuffer: true });
    this.renderer.setClearColor(0xfafafa);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 0.6));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.6);
    this.camera.add(lamp);  // at the camera
    lamp.position.set(0.3, 0.5, 1);
    this.up = new THREE.Vector3(0, 1, 0);
    this.middle = new THREE.Vector3();
    this.radius = 0;  // of the body when it was first seen
    this.range = [0, 0];
    this.obstacles = [];
    this.shows_edges = true;
    this.add_body();
    this.force = new Force(this.scene, 0xcc0000);
    this.device_force = new Force(this.scene, 0x1155cc);
    this.pen = new Pen(this.scene, 0x1155cc);
    this.before_drawing = () => {};
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  add_body() {
    this.positions = null;
    this.look = shared_uniforms();
    this.body = new THREE.Mesh(new THREE.BufferGeometry(),
      [body_material(this.look, 0xffffff), body_material(this.look, 0xff9a8a)]);  // the latter: laid open
    this.ghost = new THREE.LineSegments(new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ color: 0x4466aa, transparent: true, opacity: 0.25 }));
    this.ghost.visible = false;
    this.edges = new THREE.LineSegments(new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.3 }));
    this.blades = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xcc0000 }));
    for (const object of [this.body, this.edges, this.ghost, this.blades]) {
      object.frustumCulled = false;
      this.scene.add(object);
    }
  }

  // ---- what arrives ----

  set_up(greeting) {
    const g = greeting.gravity;
    if (g.some((x) => x !== 0)) this.up.set(-g[0], -g[1], -g[2]).normalize();
    this.origin = greeting.origin;
    this.edge = greeting.edge;
    for (const old of this.obstacles) this.scene.remove(old);
    this.obstacles = greeting.obstacles.map((given) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(given.points), 3));
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(given.triangles), 1));
      const mesh = new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({ color: 0x8899aa, flatShading: true,
        side: THREE.DoubleSide, transparent: true, opacity: 0.35, depthWrite: false }));
      mesh.matrixAutoUpdate = false;
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      return mesh;
    });
  }

  set_surface(head, corners, rest) {
    this.surface = head.surface;
    this.faces = { corners, size: head.corners };
    const per_face = 3 * (head.corners - 2);  // corners of triangles
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * head.points), 3);
    this.values = new THREE.BufferAttribute(new Float32Array(head.points), 1);
    const outside = per_face * (head.faces - head.laid_open);
    this.body.geometry.dispose();
    this.body.geometry = new THREE.BufferGeometry();
    this.body.geometry.setAttribute('position', this.positions);
    this.body.geometry.setAttribute('value', this.values);
    this.body.geometry.setIndex(new THREE.BufferAttribute(triangles_of(corners, head.corners), 1));
    this.body.geometry.addGroup(0, outside, 0);
    this.body.geometry.addGroup(outside, per_face * head.laid_open, 1);
    this.rest = rest;
    this.has_edges = false;
  }

  make_edges() {
    const index = new THREE.BufferAttribute(edges_of(this.faces.corners, this.faces.size), 1);
    const set = (lines, places) => {
      lines.geometry.dispose();
      lines.geometry = new THREE.BufferGeometry();
      lines.geometry.setAttribute('position', places);
      lines.geometry.setIndex(index);
    };
    set(this.edges, this.positions);
    set(this.ghost, new THREE.BufferAttribute(this.rest, 3));
    this.has_edges = true;
  }

  // The colours' range covers all that was seen of a field.
  set_state(head, positions, values) {
    if (head.surface !== this.surface) return;
    this.positions.array.set(positions);
    this.positions.needsUpdate = true;
    if (head.field !== this.field || head.step === 0) this.range = head.range;
    this.field = head.field;
    this.range = [Math.min(this.range[0], head.range[0]), Math.max(this.range[1], head.range[1])];
    this.look.range.value.set(...this.range);
    this.look.is_number.value = head.field === 'island';  // of a piece
    for (let i = 0; i < values.length; ++i)
      this.values.array[i] = Number.isFinite(values[i]) ? values[i] : no_value;
    this.values.needsUpdate = true;
    head.poses.forEach((p, i) => {
      const mesh = this.obstacles[i];
      if (!mesh) return;
      mesh.matrix.set(p[0], p[3], p[6], p[9], p[1], p[4], p[7], p[10], p[2], p[5], p[8], p[11], 0, 0, 0, 1);
      mesh.matrixWorldNeedsUpdate = true;
    });
    this.show_blades(head.blades);
    if (this.radius === 0) this.look_at_body(positions);
    this.show_held(head.hand, head.device);
    this.draw_now();
  }

  show_blades(blades) {
    const ends = blades.flatMap((points) => points.flatMap((_, i) => (i % 3 === 0 && i + 5 < points.length ? points.slice(i, i + 6) : [])));
    this.blades.visible = ends.length > 0;
    this.blades.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(ends), 3));
  }

  show_held(hand, device) {
    const place = (held) => held && new THREE.Vector3(...held.place.map((x, axis) => x - this.origin[axis]));
    this.force.show(hand, place(hand), 0.5 * this.radius);
    this.device_force.show(device, place(device), 0.5 * this.radius);
    this.pen.show(device, place(device), this.up, 0.15 * this.radius);
  }

  // ---- camera ----

  fit() {
    if (this.positions) this.look_at_body(this.positions.array);
  }

  look_at_body(positions) {
    const box = new THREE.Box3().setFromArray(positions);
    this.box = box;
    box.getCenter(this.middle);
    this.radius = box.getSize(new THREE.Vector3()).length() / 2;
    this.camera.up.copy(this.up);
    const size = box.getSize(new THREE.Vector3());
    // From the side of the smallest horizontal extent, a little from above.
    const axes = [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 0, 1)]
      .filter((axis) => Math.abs(axis.dot(this.up)) < 0.9)
      .sort((a, b) => Math.abs(size.dot(a)) - Math.abs(size.dot(b)));
    const from = axes[0].clone().multiplyScalar(axes[0].y !== 0 ? -1 : 1)
      .addScaledVector(axes[1], 0.25).addScaledVector(this.up, 0.35);
    // As far away as makes it fit.
    const half = (axis) => Math.abs(size.dot(axis)) / 2, slope = Math.tan(this.camera.fov * Math.PI / 360);
    const across = half(axes[1]) + half(axes[0]) / 2, along = half(this.up) + half(axes[0]) / 2;
    const distance = half(axes[0]) + 1.1 * Math.max(along, across / this.camera.aspect) / slope;
    this.camera.position.copy(this.middle).addScaledVector(from.normalize(), distance);
    this.aim();
  }

  aim() {
    const distance = this.camera.position.distanceTo(this.middle);
    this.camera.near = distance / 100;
    this.camera.far = distance + 20 * this.radius;
    this.camera.lookAt(this.middle);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.draw();
  }

  turn(right, down) {  // rad
    const arm = this.camera.position.clone().sub(this.middle).applyAxisAngle(this.up, -right);
    const side = new THREE.Vector3().crossVectors(this.up, arm).normalize();
    const tilted = arm.clone().applyAxisAngle(side, -down);
    if (Math.abs(tilted.clone().normalize().dot(this.up)) < 0.995) arm.copy(tilted);
    this.camera.position.copy(this.middle).add(arm);
    this.aim();
  }

  zoom(factor) {
    this.camera.position.sub(this.middle).multiplyScalar(factor).add(this.middle);
    this.aim();
  }

  move(right, down) {  // parts of the height of the picture
    const height = 2 * this.camera.position.distanceTo(this.middle) * Math.tan(this.camera.fov * Math.PI / 360);
    const shift = new THREE.Vector3(-right * height, down * height, 0).applyQuaternion(this.camera.quaternion);
    this.middle.add(shift);
    this.camera.position.add(shift);
    this.aim();
  }

  // The direction of a point of the canvas, as seen from the camera.
  direction(x, y) {
    const part = new THREE.Vector3(2 * x / this.canvas.clientWidth - 1, 1 - 2 * y / this.canvas.clientHeight, 0.5);
    return part.unproject(this.camera).sub(this.camera.position).normalize();
  }

  // The inverse: where a place is on the canvas.
  on_canvas(place) {
    const part = new THREE.Vector3(...place).project(this.camera);
    return [(part.x + 1) / 2 * this.canvas.clientWidth, (1 - part.y) / 2 * this.canvas.clientHeight];
  }

  ray(x, y) {
    return new THREE.Raycaster(this.camera.position.clone(), this.direction(x, y));
  }

  // What of the body is under a point of the canvas: {point, rest}, its place and that at rest, or null.
  hit(x, y) {
    if (!this.positions) return null;
    this.body.geometry.computeBoundingSphere();
    const [hit] = this.ray(x, y).intersectObject(this.body);
    if (!hit) return null;
    const at = (array, i) => new THREE.Vector3().fromArray(array, 3 * i);
    const corners = [hit.face.a, hit.face.b, hit.face.c], now = corners.map((i) => at(this.positions.array, i));
    const parts = THREE.Triangle.getBarycoord(hit.point, ...now, new THREE.Vector3());
    const rest = new THREE.Vector3();
    parts?.toArray().forEach((part, i) => rest.addScaledVector(at(this.rest, corners[i]), part));
    return { point: hit.point, rest };
  }

  // The obstacle under a point of the canvas: {tool, point}, its place in the list, or null.
  tool_at(x, y) {
    const [hit] = this.ray(x, y).intersectObjects(this.obstacles);
    return hit ? { tool: this.obstacles.indexOf(hit.object), point: hit.point } : null;
  }

  // Where the mouse leads a point: in the plane through it that faces the camera.
  led(point, x, y) {
    const ahead = this.camera.getWorldDirection(new THREE.Vector3()), way = this.direction(x, y);
    const depth = point.clone().sub(this.camera.position).dot(ahead) / way.dot(ahead);
    return this.camera.position.clone().addScaledVector(way, depth);
  }

  // Points before and behind the body, under a point of the canvas.
  depths_at([x, y]) {
    const away = this.camera.position.distanceTo(this.middle), reach = 2 * this.radius;
    const at = (depth) => this.camera.position.clone().addScaledVector(this.direction(x, y), depth);
    return [at(Math.max(away - reach, away / 100)), at(away + reach)];
  }

  // Through the camera and two points of the canvas, as deep as the body.
  plane_through(a, b) {
    const [near_a, far_a] = this.depths_at(a), [near_b, far_b] = this.depths_at(b);
    return [near_a, far_a, far_b, near_b];
  }

  // What a blade along the line of sight has swept on a way over the canvas: {points, triangles}.
  swept(way) {
    const points = way.flatMap((place) => this.depths_at(place)), triangles = [];
    for (let i = 0; i + 3 < points.length; i += 2) triangles.push([i, i + 1, i + 3], [i, i + 3, i + 2]);
    return { points, triangles };
  }

  clip(axis, part) {
    const normal = { x: [-1, 0, 0], y: [0, -1, 0], z: [0, 0, -1] }[axis];
    this.renderer.clippingPlanes = [];
    for (const material of this.body.material) material.side = normal ? THREE.DoubleSide : THREE.FrontSide;
    if (normal && this.box) {
      const at = this.box.min[axis] + part * (this.box.max[axis] - this.box.min[axis]);
      this.renderer.clippingPlanes = [new THREE.Plane(new THREE.Vector3(...normal), at)];
    }
    this.draw();
  }

  // The length of something in the middle of the picture, in pixels.
  pixels(length) {
    const distance = this.camera.position.distanceTo(this.middle);
    return length * this.canvas.height / (2 * distance * Math.tan(this.camera.fov * Math.PI / 360));
  }

  // ---- drawing ----

  resize() {
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(this.canvas.clientWidth, this.canvas.clientHeight, false);
    this.camera.aspect = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // At the next refresh of the screen.
  draw() {
    if (this.is_due) return;
    this.is_due = true;
    requestAnimationFrame(() => {
      this.is_due = false;
      this.render();
    });
  }

  // At once, so that it is done by the next refresh; but only one picture for each.
  draw_now() {
    if (this.is_due || this.is_fresh) {
      this.draw();
      return;
    }
    this.is_fresh = true;
    requestAnimationFrame(() => { this.is_fresh = false; });
    this.render();
  }

  render() {
    this.before_drawing();
    this.edges.visible = this.shows_edges && this.pixels(this.edge) >= shortest_edge;
    if (this.faces && !this.has_edges && (this.edges.visible || this.ghost.visible)) this.make_edges();
    this.renderer.render(this.scene, this.camera);
  }
}
