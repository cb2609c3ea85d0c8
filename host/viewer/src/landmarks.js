// The page of `facezip landmarks`: a template and a scan beside each other; a click on the scan places the landmark that
// the template shows.
import * as THREE from 'three';
import { TrackballControls } from 'three/examples/jsm/controls/TrackballControls.js';

const byId = (id) => document.getElementById(id);
const colours = { placed: 0x81c995, current: 0xfdd663 };

async function fetched(name) {
  const answer = await fetch(`scene/${name}`);
  if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
  return answer;
}

/** A mesh of corners: positions less their origin, UVs, colours, all of all corners one after the other. */
async function loadMesh(about) {
  const numbers = new Float32Array(await (await fetched(about.mesh)).arrayBuffer());
  const corners = 3 * about.triangles;
  let at = 0;
  const attribute = (size) => new THREE.BufferAttribute(numbers.subarray(at, (at += corners * size)), size);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', attribute(3));
  if (about.uvs) geometry.setAttribute('uv', attribute(2));
  if (about.colours) geometry.setAttribute('color', attribute(3));
  geometry.computeVertexNormals();
  const materials = await Promise.all(about.groups.map(async ({ texture }) => {
    const material = new THREE.MeshStandardMaterial({ color: 0xb0b0b0, roughness: 1, side: THREE.DoubleSide, flatShading: true });
    if (texture) {
      const picture = new THREE.Texture(await createImageBitmap(await (await fetched(texture)).blob(), { imageOrientation: 'flipY' }));
      picture.flipY = false;  // bitmaps were turned as they were read
      picture.colorSpace = THREE.SRGBColorSpace;
      picture.wrapS = picture.wrapT = THREE.RepeatWrapping;
      picture.needsUpdate = true;
      material.userData.map = picture;
    }
    material.userData.coloured = about.colours;
    return material;
  }));
  about.groups.forEach(({ first, count }, g) => geometry.addGroup(3 * first, 3 * count, g));
  return new THREE.Mesh(geometry, materials);
}

/** A canvas with a mesh, and its landmarks as balls. */
class Pane {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0x202124);
    this.camera = new THREE.PerspectiveCamera(28, 1, 1, 1000);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x777777, 2.0), this.camera);
    const key = new THREE.DirectionalLight(0xffffff, 1.4);
    this.camera.add(key);
    this.controls = new TrackballControls(this.camera, canvas);
    Object.assign(this.controls, { rotateSpeed: 3, staticMoving: true });
    this.ball = new THREE.SphereGeometry(1, 16, 12);
    this.balls = new THREE.Group();
    this.scene.add(this.balls);
  }

  async show(about) {
    const mesh = await loadMesh(about);
    if (this.mesh) {
      this.scene.remove(this.mesh);
      this.mesh.geometry.dispose();
      for (const material of this.mesh.material) { material.userData.map?.dispose(); material.dispose(); }
    }
    this.about = about;
    this.mesh = mesh;
    this.scene.add(mesh);
    const box = new THREE.Box3().setFromBufferAttribute(mesh.geometry.attributes.position);
    const size = box.getSize(new THREE.Vector3());
    this.resize();
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    const distance = 0.55 * Math.max(size.y / slope, size.x / (slope * this.camera.aspect)) + size.z / 2;
    this.controls.reset();
    box.getCenter(this.controls.target);
    this.camera.up.set(0, 1, 0);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(0, 0, distance));
    this.camera.near = distance / 1000;
    this.camera.far = distance * 100;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  useTexture(on) {
    for (const material of this.mesh.material) {
      material.map = on ? material.userData.map ?? null : null;
      material.vertexColors = on && material.userData.coloured;
      material.color.set(material.map || material.vertexColors ? 0xffffff : 0xb0b0b0);
      material.needsUpdate = true;
    }
  }

  /** points: by name, as files have them. */
  mark(points, current) {
    this.balls.clear();
    for (const [name, place] of Object.entries(points)) {
      const is = name === current;
      const ball = new THREE.Mesh(this.ball, new THREE.MeshBasicMaterial({ color: is ? colours.current : colours.placed }));
      ball.position.fromArray(place.map((p, axis) => p - this.about.origin[axis]));
      ball.scale.setScalar(this.about.size * (is ? 0.008 : 0.004));
      this.balls.add(ball);
    }
  }

  /** Where on the mesh a point of the page lies, as files have it; null beside it. */
  pick(x, y) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height), this.camera);
    const [hit] = ray.intersectObject(this.mesh);
    return hit ? hit.point.toArray().map((p, axis) => p + this.about.origin[axis]) : null;
  }

  /** Where a place of the file is on the page. */
  project(place) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    this.camera.updateMatrixWorld();
    const at = new THREE.Vector3(...place.map((p, axis) => p - this.about.origin[axis])).project(this.camera);
    return { x: left + ((at.x + 1) / 2) * width, y: top + ((1 - at.y) / 2) * height };
  }

  /** Draws as many pixels as the page gives the canvas. */
  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    if (this.width === clientWidth && this.height === clientHeight) return;
    [this.width, this.height] = [clientWidth, clientHeight];
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(1, clientHeight);
    this.camera.updateProjectionMatrix();
    this.controls.handleResize();
  }

  render() {
    this.resize();
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }
}

/** Landmarks of all scans, and how they came about. */
class Landmarks {
  constructor(names, scans) {
    this.names = names;
    this.scans = scans;
    this.past = [];
    this.saved = JSON.stringify(scans);
  }
  of(scan) { return this.scans[scan] ?? {}; }
  put([scan, name, place]) {
    const of = (this.scans[scan] ??= {});
    if (place) of[name] = place;
    else delete of[name];
  }
  /** place: null takes it away. */
  set(scan, name, place) {
    const of = this.of(scan);
    this.past.push([scan, name, Object.hasOwn(of, name) ? of[name] : null]);
    this.put([scan, name, place]);
  }
  /** Takes the last change back; the scan and name that it was of. */
  undo() {
    const last = this.past.pop();
    if (last) this.put(last);
    return last ? { scan: last[0], name: last[1] } : null;
  }
  get changed() { return JSON.stringify(this.scans) !== this.saved; }
}

async function start() {
  const scene = await (await fetched('scene.json')).json();
  const names = Object.keys(scene.template.landmarks);
  const known = new Set(scene.scans.map(({ name }) => name));
  const landmarks = new Landmarks(names, Object.fromEntries(Object.entries(scene.landmarks).filter(([scan]) => known.has(scan))));
  const panes = { template: new Pane(byId('template')), scan: new Pane(byId('scan')) };
  const state = { scan: null, name: names[0] };

  const buttons = new Map(names.map((name) => {
    const button = document.createElement('button');
    button.textContent = name;
    button.addEventListener('click', () => choose(name));
    const item = document.createElement('li');
    item.append(button);
    byId('landmarks').append(item);
    return [name, button];
  }));
  for (const { name } of scene.scans) byId('scans').append(new Option(name, name));

  function show() {
    const placed = landmarks.of(state.scan.name);
    panes.template.mark(scene.template.landmarks, state.name);
    panes.scan.mark(placed, state.name);
    byId('wanted').textContent = state.name ?? '';
    for (const [name, button] of buttons) {
      button.classList.toggle('placed', Object.hasOwn(placed, name));
      button.setAttribute('aria-current', String(name === state.name));
    }
    byId('save').disabled = !landmarks.changed;
    byId('undo').disabled = landmarks.past.length === 0;
    byId('remove').disabled = !Object.hasOwn(placed, state.name);
  }
  function say(text) { byId('note').textContent = text; }
  function sayCount() {
    say(`${state.scan.name}: ${Object.keys(landmarks.of(state.scan.name)).length} of ${names.length}`);
  }
  function choose(name) {
    state.name = name;
    buttons.get(name)?.scrollIntoView({ block: 'nearest' });
    show();
  }
  function step(by) { choose(names[(names.indexOf(state.name) + by + names.length) % names.length]); }
  /** The next one that the scan lacks, else the next. */
  function goOn() {
    const placed = landmarks.of(state.scan.name);
    const at = names.indexOf(state.name);
    const later = [...names.slice(at + 1), ...names.slice(0, at)];
    choose(later.find((name) => !Object.hasOwn(placed, name)) ?? later[0] ?? state.name);
  }
  function place(point) {
    landmarks.set(state.scan.name, state.name, point);
    sayCount();
    if (byId('advance').checked) goOn();
    else show();
  }
  function remove() {
    if (!Object.hasOwn(landmarks.of(state.scan.name), state.name)) return;
    landmarks.set(state.scan.name, state.name, null);
    sayCount();
    show();
  }
  async function undo() {
    const last = landmarks.undo();
    if (!last) return;
    if (last.scan !== state.scan.name) await open(last.scan);
    sayCount();
    choose(last.name);
  }
  async function open(name) {
    state.scan = scene.scans.find((scan) => scan.name === name);
    byId('scans').value = name;
    say('Reading the scan ...');
    await panes.scan.show(state.scan);
    panes.scan.useTexture(byId('texture').checked);
    say('');
    show();
  }
  async function save() {
    const text = JSON.stringify(landmarks.scans);
    const answer = await fetch('landmarks', { method: 'PUT', headers: { 'Content-Type': 'application/json' }, body: text });
    const said = answer.ok ? await answer.json() : { error: `the server says ${answer.status}` };
    if (said.saved) landmarks.saved = text;
    say(said.saved ? `Saved to ${scene.file}` : `Not saved: ${said.error}`);
    show();
  }

  let pressed = null;
  const canvas = panes.scan.canvas;
  canvas.addEventListener('pointerdown', (event) => { pressed = event.button === 0 ? [event.clientX, event.clientY] : null; });
  canvas.addEventListener('pointerup', (event) => {
    // A drag turns the head.
    const still = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4;
    pressed = null;
    const point = still && state.name ? panes.scan.pick(event.clientX, event.clientY) : null;
    if (point) place(point);
  });
  byId('scans').addEventListener('change', () => open(byId('scans').value));
  byId('texture').addEventListener('change', () => panes.scan.useTexture(byId('texture').checked));
  for (const [id, action] of Object.entries({ next: () => step(1), previous: () => step(-1), remove, undo, save })) {
    byId(id).addEventListener('click', action);
  }
  addEventListener('keydown', (event) => {
    const key = event.key.toLowerCase();
    const action = event.ctrlKey || event.metaKey ? { z: undo, s: save }[key]
      : { n: () => step(1), p: () => step(-1), delete: remove, backspace: remove }[key];
    if (!action || event.target.matches('input[type=text], select')) return;
    event.preventDefault();
    action();
  });
  addEventListener('beforeunload', (event) => { if (landmarks.changed) event.preventDefault(); });

  await panes.template.show(scene.template);
  panes.template.useTexture(false);
  await open(scene.scans[0].name);
  const draw = () => {
    for (const pane of Object.values(panes)) pane.render();
    requestAnimationFrame(draw);
  };
  draw();
  return { panes, landmarks, state };
}

const ready = start();
globalThis.facezip = { ready };
ready.then((page) => { globalThis.facezip.page = page; }, (error) => {
  byId('message').textContent = String(error.message ?? error);
  byId('message').hidden = false;
});
