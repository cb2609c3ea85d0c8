// The head on its turntable, or a flat sheet of texture.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { memory } from './blend.js';
import { composeTargets } from './composed.js';
import { loadParts, setMorphs } from './parts.js';

export class HeadScene {
  constructor(canvas) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.toneMapping = THREE.NoToneMapping;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0x202124);
    this.camera = new THREE.PerspectiveCamera(28, 1, 0.001, 1000);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x555555, 1.6));
    const key = new THREE.DirectionalLight(0xffffff, 2.2);
    key.position.set(0.6, 0.8, 1);
    this.camera.add(key);  // the light stays with the viewer: wrinkles show as the head turns
    this.scene.add(this.camera);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.sheet = new THREE.Mesh(new THREE.PlaneGeometry(1, 1));
    const uv = this.sheet.geometry.attributes.uv;
    for (let i = 0; i < uv.count; ++i) uv.setY(i, 1 - uv.getY(i));  // row 0 on top
    this.scene.add(this.sheet);
  }

  /** Loads mesh and parts. Returns the names of the mesh's morph targets. */
  async loadMesh(readFile, description) {
    const bytes = await readFile(description.mesh.file);
    const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '');
    gltf.scene.traverse((node) => { if (node.isMesh) this.head = node; });
    composeTargets(this.head);
    this.scene.add(this.head);
    const { geometry } = this.head;
    // Of the neutral: three.js adds up the reach of all morph targets.
    this.bounds = new THREE.Box3().setFromBufferAttribute(geometry.attributes.position);
    this.head.frustumCulled = false;
    const count = geometry.attributes.position.count;
    const targets = geometry.morphAttributes.position?.length ?? 0;
    memory.bytes += count * 32 + (geometry.index?.count ?? 0) * 4 + count * 32 * targets;  // morphs: RGBA32F, normals too
    this.parts = await loadParts(readFile, description);
    for (const part of this.parts) this.scene.add(part);
    return Object.keys(this.head.morphTargetDictionary ?? {});
  }

  /** Weights by names of expressions. */
  setMorphs(names, weights) {
    if (!this.head) return;
    const byName = new Map(names.map((name, n) => [name, weights[n]]));
    setMorphs([this.head, ...this.parts], (name) => byName.get(name));
  }

  /** Shows the head, or a sheet of the given proportions, and looks at it from the front. */
  show(flat, aspect) {
    this.flat = flat || !this.head;
    this.sheet.visible = this.flat;
    if (this.head) this.head.visible = !this.flat;
    this.sheet.scale.set(aspect, 1, 1);
    this.showParts();
    this.frame();
  }

  /** Looks from the front, so near that the head fits however it turns. */
  frame() {
    const box = this.flat ? new THREE.Box3().setFromObject(this.sheet) : this.bounds;
    const center = box.getCenter(new THREE.Vector3());
    const half = box.getSize(new THREE.Vector3()).multiplyScalar(0.5);
    const around = Math.hypot(half.x, half.z);
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    const distance = 1.08 * Math.max(half.y / slope, around / (slope * this.camera.aspect)) + half.z;
    this.controls.target.copy(center);
    this.camera.position.copy(center).add(new THREE.Vector3(0, 0, distance));
    this.camera.near = distance / 100;
    this.camera.far = distance * 100;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** shaded: as a head that one sees, with its eyes and teeth, and not as a look into the package. */
  setMaterial(material, shaded) {
    this.material?.dispose();
    this.material = material;
    this.sheet.material = material;
    this.shaded = shaded;
    if (this.head) this.head.material = material;
    this.showParts();
  }

  showParts() {
    for (const part of this.parts ?? []) part.visible = this.shaded && !this.flat;
  }

  /** Fits the canvas to what the panel leaves of the window. */
  resize(width, height) {
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(Math.max(64, width), Math.max(64, height));
    this.camera.aspect = this.renderer.domElement.width / this.renderer.domElement.height;
    this.camera.updateProjectionMatrix();
  }

  render() {
    this.renderer.render(this.scene, this.camera);
  }
}
