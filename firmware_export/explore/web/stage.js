// SPDX-License-Identifier: MIT
// The 3-D picture: camera, lights, ground; gravity always points down on the screen.
const RATE = 0.006; // rad a pixel

// Smooth edges take four times the work, too much where no graphics card does it.
function contextOf(canvas) {
  const smooth = { antialias: true, failIfMajorPerformanceCaveat: true };
  const wish = { alpha: false, depth: true, stencil: false };
  return canvas.getContext("webgl2", { ...wish, ...smooth }) ?? canvas.getContext("webgl2", wish);
}

function groundOf(size) {
  const reach = 2.1 * size, step = reach / 7, lines = [];
  for (let at = -6 * step; at < 6.5 * step; at += step) {
    const half = Math.sqrt(reach * reach - at * at);
    lines.push(at, -half, 0, at, half, 0, -half, at, 0, half, at, 0);
  }
  const grid = new THREE.BufferGeometry();
  grid.setAttribute("position", new THREE.BufferAttribute(new Float32Array(lines), 3));
  const ground = new THREE.Mesh(new THREE.CircleGeometry(reach, 72), lit("ground"));
  ground.renderOrder = -1;
  ground.add(new THREE.LineSegments(grid, flat("rim", { opacity: 0.35 })));
  return ground;
}

class Stage {
  constructor(canvas, scene) {
    const { size } = scene;
    Object.assign(this, { canvas, size });
    this.robot = new Robot(scene);
    this.marks = new Marks(size);
    this.ground = groundOf(size);
    const cone = new THREE.ConeGeometry(0.035 * size, 0.11 * size, 4).rotateZ(-Math.PI / 2);
    this.ahead = new THREE.Mesh(cone, flat("soft"));
    this.world = new THREE.Group(); // the body frame, turned so that gravity points down
    this.world.add(this.robot.body, this.ground, this.marks, this.ahead);
    this.renderer = new THREE.WebGLRenderer({ canvas, context: contextOf(canvas) });
    this.renderer.debug.checkShaderErrors = false; // asking waits until each has been compiled
    const sun = new THREE.DirectionalLight(0xffffff, 2.1);
    sun.position.set(2, -3, 5);
    this.scene = new THREE.Scene();
    this.scene.add(sun, new THREE.HemisphereLight(0xffffff, 0x8a8175, 1.3),
      new THREE.AmbientLight(0xffffff, 0.35), this.world);
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01 * size, 60 * size);
    this.camera.up.copy(Z);
    this.ray = new THREE.Raycaster();
  }

  // The camera is moved by hand, but for drags that begin on the ground or the body.
  attach(state) {
    const { canvas } = this;
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      const what = event.button === 0 && this.answer ? this.hit(event) : "";
      if (!what) return;
      canvas.setPointerCapture(event.pointerId);
      const { tilt, heading } = state.now;
      held = { x: event.clientX, y: event.clientY, what };
      held.down = what === "body" ? this.answer.g.clone() : tilted(tilt, heading);
      event.stopImmediatePropagation();
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) {
        canvas.style.cursor = !event.buttons && this.hit(event) ? "grab" : "move";
        return;
      }
      const { clientX: x, clientY: y } = event;
      const down = this.nudged(held.down, (x - held.x) * RATE, (held.y - y) * RATE);
      held = { ...held, x, y, down };
      state.set({ mode: held.what, ...angles(held.down) });
    });
    canvas.onpointerup = canvas.onpointercancel = () => (held = null);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.home();
  }

  // Look from the front left, as near as lets all of the robot be seen at its home posture.
  home() {
    const { scene } = this.robot;
    this.robot.pose(scene.parameters.map((p) => p.home));
    const contacts = this.robot.contacts(), points = contacts.map(([at]) => at);
    scene.links.forEach(({ name, shapes, mass, com }) => {
      points.push(this.robot.place(name, [0, 0, 0]));
      if (shapes.length || mass > 0) points.push(this.robot.place(name, com));
    });
    const middle = new THREE.Box3().setFromPoints(points).getCenter(new Vector3());
    const round = Math.max(...contacts.map(([, radius]) => radius));
    const reach = round + Math.max(...points.map((p) => p.distanceTo(middle)));
    const far = 3.7 * Math.max(0.6 * this.size, reach);
    this.camera.position.set(0.62, -0.68, 0.34).multiplyScalar(far).add(middle);
    this.controls.target.copy(middle);
    this.controls.update();
    if (this.answer) this.show(this.answer);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.fov = this.camera.aspect < 1 ? 44 : 32;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  recolour(colours) {
    this.renderer.setClearColor(colours.page, 1);
    LOOKS.forEach(({ colour, material }) => material.color.set(colours[colour]));
    this.dirty = true;
  }

  show(answer) {
    const { here, g, q } = this.answer = answer;
    this.robot.pose(q);
    this.world.quaternion.setFromUnitVectors(g, new Vector3(0, 0, -1));
    this.ground.visible = Boolean(here);
    if (here) {
      const up = here.plane.clone().normalize().negate();
      this.ground.quaternion.setFromUnitVectors(Z, up);
      this.ground.position.copy(up).multiplyScalar(-here.height - 0.002 * this.size);
    }
    const ahead = Math.max(0.3 * this.size, ...this.robot.contacts().map(([at, r]) => at.x + r));
    this.ahead.position.set(ahead + 0.14 * this.size, 0, 0);
    this.marks.show(answer);
    this.dirty = true;
  }

  // "body", "ground" or "" under the pointer.
  hit({ offsetX, offsetY }) {
    const { clientWidth, clientHeight } = this.canvas;
    const at = new THREE.Vector2(2 * offsetX / clientWidth - 1, 1 - 2 * offsetY / clientHeight);
    this.ray.setFromCamera(at, this.camera);
    if (this.ray.intersectObject(this.robot.body).length) return "body";
    const met = this.ground.visible && this.ray.intersectObject(this.ground, false).length;
    return met ? "ground" : "";
  }

  // A direction of gravity turned towards the screen's right, and away from the reader.
  nudged(down, right, away) {
    const [x, y] = this.camera.matrixWorld.elements; // what is to the right on the screen
    const push = new Vector3(right * x - away * y, right * y + away * x, 0);
    push.divideScalar(Math.hypot(x, y));
    const turn = this.world.quaternion.clone().invert();
    const moved = push.applyQuaternion(turn).add(down).normalize();
    return moved.z < 0.2 ? moved : down;
  }

  render() {
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
  }
}
