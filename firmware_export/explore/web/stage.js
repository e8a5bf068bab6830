// SPDX-License-Identifier: MIT
// The 3-D picture: camera, lights, ground; gravity always points down on the screen.
import {
  AmbientLight, BufferGeometry, CircleGeometry, ConeGeometry, DirectionalLight, Group,
  HemisphereLight, LineSegments, Matrix4, Mesh, PerspectiveCamera, Quaternion, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { frames, posture } from "./kinematics.js";
import { flat, lit, places } from "./looks.js";
import { Marks } from "./marks.js";
import { bodies } from "./solids.js";
import { add, apply, length, minus, scale, unit } from "./vector.js";

// Smooth edges take four times the work, too much where no graphics card does it.
function contextOf(canvas) {
  const wish = { alpha: false, depth: true, stencil: false };
  return canvas.getContext("webgl2", { ...wish, antialias: true, failIfMajorPerformanceCaveat: true }) ||
    canvas.getContext("webgl2", { ...wish, antialias: false });
}

export class Stage {
  constructor(canvas, scene) {
    this.canvas = canvas;
    this.robot = scene;
    this.renderer = new WebGLRenderer({ canvas, context: contextOf(canvas) });
    this.renderer.debug.checkShaderErrors = false; // asking waits until each has been compiled
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01 * scene.size, 60 * scene.size);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.home();
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.invalidate());
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(2, -3, 5);
    this.scene.add(sun, new HemisphereLight(0xffffff, 0x8a8175, 1.3), new AmbientLight(0xffffff, 0.35));
    this.world = new Group(); // the body frame, turned so that gravity points down
    this.scene.add(this.world);
    this.ray = new Raycaster();
    this.dirty = true;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  // Look at the robot from its front left, as near as lets all of it be seen at its home posture.
  home() {
    const { parameters, links, contacts, size } = this.robot, { camera } = this;
    const seen = posture(this.robot, parameters.map((p) => p.home));
    const points = seen.contacts.map((one) => one.centre);
    links.forEach((link, i) => {
      const { turn, at } = seen.frames[i], drawn = link.shapes.length || link.mass > 0;
      points.push(minus(at, seen.com), ...(drawn ? [minus(add(at, apply(turn, link.com)), seen.com)] : []));
    });
    const middle = [0, 1, 2].map((k) => {
      const row = points.map((p) => p[k]);
      return (Math.min(...row) + Math.max(...row)) / 2;
    });
    const round = Math.max(...contacts.map((one) => one.radius));
    const reach = Math.max(0.6 * size, round + Math.max(...points.map((p) => length(minus(p, middle)))));
    const far = 3.7 * reach;
    camera.position.set(middle[0] + 0.62 * far, middle[1] - 0.68 * far, middle[2] + 0.34 * far);
    camera.lookAt(...middle);
    if (this.controls) this.controls.target.set(...middle);
  }

  invalidate() {
    this.dirty = true;
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.fov = this.camera.aspect < 1 ? 44 : 32;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  // Build everything that has a colour; called again when the theme changes.
  paint(colours) {
    this.world.clear();
    this.renderer.setClearColor(colours.page, 1);
    this.links = bodies(this.robot, colours);
    this.body = new Group();
    this.body.add(...this.links);
    this.marks = new Marks(this.robot, colours);
    this.ahead = new Mesh(new ConeGeometry(0.035 * this.robot.size, 0.11 * this.robot.size, 4).rotateZ(-Math.PI / 2), flat(colours.soft));
    const reach = 2.1 * this.robot.size;
    this.ground = new Mesh(new CircleGeometry(reach, 72), lit(colours.ground));
    this.ground.renderOrder = -1;
    const lines = [], step = reach / 7;
    for (let k = -6; k <= 6; k++) {
      const at = k * step, half = Math.sqrt(reach * reach - at * at);
      lines.push(at, -half, 0, at, half, 0, -half, at, 0, half, at, 0);
    }
    const grid = new BufferGeometry();
    places(grid, lines);
    this.ground.add(new LineSegments(grid, flat(colours.rim, { opacity: 0.35 })));
    this.world.add(this.body, this.ground, this.marks.group, this.ahead);
    this.renderer.compile(this.scene, this.camera); // which goes on while the answer is computed
    if (this.answer) this.show(this.answer, this.q);
    this.invalidate();
  }

  // Show an answer of the worker for joints q.
  show(answer, q) {
    this.answer = answer;
    this.q = q;
    frames(this.robot, q).forEach(({ turn: t, at }, i) => {
      const [x, y, z] = minus(at, answer.com);
      this.links[i].matrix.set(t[0], t[1], t[2], x, t[3], t[4], t[5], y, t[6], t[7], t[8], z, 0, 0, 0, 1);
      this.links[i].matrixWorldNeedsUpdate = true;
    });
    this.world.quaternion.setFromUnitVectors(new Vector3(...answer.g), new Vector3(0, 0, -1));
    const facet = answer.facets[answer.facet];
    this.ground.visible = Boolean(facet);
    if (facet) {
      const up = scale(unit(facet.plane), -1);
      this.ground.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...up)));
      this.ground.position.set(...scale(up, -facet.height - 0.002 * this.robot.size));
    }
    const reach = answer.contacts.map((one) => one.centre[0] + one.radius);
    this.ahead.position.set(Math.max(0.3 * this.robot.size, ...reach) + 0.14 * this.robot.size, 0, 0);
    this.marks.show(answer);
    this.invalidate();
  }

  // "body", "ground" or "" at a place of the canvas.
  hit(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2);
    this.ray.setFromCamera(at, this.camera);
    if (this.ray.intersectObject(this.body, true).length) return "body";
    return this.ground.visible && this.ray.intersectObject(this.ground, false).length ? "ground" : "";
  }

  // The screen's right and away, level in the world.
  level() {
    const right = new Vector3().setFromMatrixColumn(new Matrix4().copy(this.camera.matrixWorld), 0);
    const flat = unit([right.x, right.y, 0]);
    return { right: flat, away: [-flat[1], flat[0], 0] };
  }

  render() {
    if (!this.dirty) return false;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    const gl = this.renderer.getContext();
    this.fence ??= gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    return true;
  }

  // Whether the first picture is not only asked for, but made.
  isShown() {
    const gl = this.renderer.getContext();
    return Boolean(this.fence) && gl.getSyncParameter(this.fence, gl.SYNC_STATUS) === gl.SIGNALED;
  }
}
