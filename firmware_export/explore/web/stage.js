// SPDX-License-Identifier: MIT
// The 3-D picture: camera, lights, ground; gravity always points down on the screen.
const RATE = 0.006; // rad a pixel

function groundOf(size) {
  const reach = 2.1 * size, step = reach / 7, lines = [];
  for (let at = -6 * step; at < 6.5 * step; at += step) {
    const half = Math.sqrt(reach * reach - at * at);
    [[at, -half], [at, half], [-half, at], [half, at]].forEach((place) =>
      lines.push(new Vector3(...place)));
  }
  const grid = new THREE.BufferGeometry().setFromPoints(lines);
  const ground = solid(new THREE.CircleGeometry(reach, 72), lit("ground"), new Vector3(), -1);
  ground.add(new THREE.LineSegments(grid, flat("rim", { opacity: 0.35 })));
  return ground;
}

class Stage {
  constructor(canvas, scene) {
    const { size } = scene, robot = new Robot(scene), marks = new Marks(size);
    Object.assign(this, { canvas, size, robot, marks, ground: groundOf(size) });
    const cone = new THREE.ConeGeometry(0.035 * size, 0.11 * size, 4).rotateZ(-Math.PI / 2);
    this.ahead = new THREE.Mesh(cone, flat("soft"));
    this.world = new THREE.Group(); // the body frame, turned so that gravity points down
    this.world.add(robot.body, this.ground, marks, this.ahead);
    // Smooth edges take four times the work, too much where no graphics card does it.
    const asked = { failIfMajorPerformanceCaveat: true };
    const antialias = Boolean(document.createElement("canvas").getContext("webgl2", asked));
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias });
    this.renderer.debug.checkShaderErrors = false; // asking waits until each has been compiled
    const sun = new THREE.DirectionalLight(0xffffff, 2.1);
    sun.position.set(2, -3, 5);
    this.scene = new THREE.Scene();
    this.scene.add(sun, new THREE.HemisphereLight(0xffffff, 0xaca7a0, 1.65), this.world);
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
      const { tilt, heading } = state.now, { clientX: x, clientY: y } = event;
      held = { x, y, what, down: what === "body" ? this.answer.g : tilted(tilt, heading) };
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
      state.set({ mode: held.what, ...angles(down) });
    });
    canvas.onpointerup = canvas.onpointercancel = () => (held = null);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.home();
  }

  // Look from the front left, as near as lets all of the robot be seen at its home posture.
  home() {
    this.robot.pose(this.robot.scene.parameters.map(({ home, unit }) => home * unit));
    this.world.quaternion.identity();
    const box = new THREE.Box3().setFromObject(this.robot.body);
    const { center, radius } = box.getBoundingSphere(new THREE.Sphere());
    const far = 3.7 * Math.max(0.6 * this.size, radius);
    this.camera.position.set(0.62, -0.68, 0.34).multiplyScalar(far).add(center);
    this.controls.target.copy(center);
    this.controls.update();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
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
    const { here, g, q, pose } = this.answer = answer;
    this.robot.pose(q);
    const ahead = Math.max(0.3 * this.size, ...pose.edges.map(({ start }) => start.x));
    this.ahead.position.set(ahead + 0.2 * this.size, 0, 0);
    this.world.quaternion.setFromUnitVectors(g, new Vector3(0, 0, -1));
    this.ground.visible = Boolean(here);
    if (here) {
      const up = here.plane.clone().normalize().negate();
      this.ground.quaternion.setFromUnitVectors(Z, up);
      this.ground.position.copy(up).multiplyScalar(-here.height - 0.002 * this.size);
    }
    this.marks.show(answer);
    this.dirty = true;
  }

  // "body", "ground" or "" under the pointer.
  hit({ offsetX, offsetY }) {
    const { clientWidth, clientHeight } = this.canvas;
    const at = new THREE.Vector2(2 * offsetX / clientWidth - 1, 1 - 2 * offsetY / clientHeight);
    this.ray.setFromCamera(at, this.camera);
    if (this.ray.intersectObject(this.robot.body).length) return "body";
    const { ground } = this, met = this.ray.intersectObject(ground, false).length;
    return ground.visible && met ? "ground" : "";
  }

  // A direction of gravity turned towards the screen's right, and away from the reader.
  nudged(down, right, away) {
    const [x, y] = this.camera.matrixWorld.elements; // what is to the right on the screen
    const push = new Vector3(right * x - away * y, right * y + away * x, 0);
    push.divideScalar(Math.hypot(x, y)).applyQuaternion(this.world.quaternion.clone().invert());
    const moved = push.add(down).normalize();
    return moved.z < 0.2 ? moved : down;
  }

  render() {
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
  }
}
