// The page of `facezip view`: a head whose mesh and textures follow one set of sliders.
import { PackageTextures, memory } from './blend.js';
import { readClip } from './clip.js';
import { fileReader } from './files.js';
import { cellGains, fromPreset, toPreset, unitGains } from './gains.js';
import { legends, mapOfRole, maskPicture, shadedMaterial, viewMaterial } from './materials.js';
import { readDescription, readMasks } from './package.js';
import { byId, download, fail, filterRows, note, onFile, options, showLegend, slider } from './panel.js';
import { HeadScene } from './scene.js';

const modes = { shaded: 'shaded', texture: 'one map', neutral: 'its neutral', difference: 'one difference texture',
  weights: 'weights in force', change: 'amount of change', masks: 'masks', regions: 'regions' };

class Viewer {
  async load() {
    const canvas = byId('canvas');
    if (!document.createElement('canvas').getContext('webgl2')) {
      throw new Error('This page needs WebGL 2, which this browser or its graphics driver does not offer.\n' +
        'Use a current browser, with hardware acceleration switched on.');
    }
    this.head = new HeadScene(canvas);
    const { renderer } = this.head;
    renderer.debug.onShaderError = (gl, program, vertex, fragment) => {
      throw new Error(`A shader does not compile here:\n${gl.getShaderInfoLog(fragment)}${gl.getProgramInfoLog(program)}`);
    };
    if (!renderer.extensions.has('EXT_color_buffer_float')) {
      throw new Error('This page needs textures of floats that can be drawn to (EXT_color_buffer_float), which this ' +
        'graphics driver does not offer.');
    }
    const readFile = fileReader();
    this.description = await readDescription(readFile);
    byId('name').textContent = document.title = this.description.name || 'facezip';
    this.names = this.description.expressions;
    this.weights = new Float32Array(this.names.length);
    this.gains = unitGains(this.description);
    this.textures = await PackageTextures.load(readFile, this.description, renderer,
      (what) => byId('stats').textContent = `loading ${what}`);
    this.masks = await readMasks(readFile, this.description);
    this.morphs = this.description.mesh ? await this.head.loadMesh(readFile, this.description) : [];
    this.uniforms = { detail: { value: true }, layer: { value: 0 }, picture: { value: null } };
    this.buildPanel();
    this.resize();
    window.addEventListener('resize', () => this.resize());
    this.showMode();
    if (!this.description.mesh) note('The package has no mesh: its textures are shown flat.');
    else if (!this.morphs.length) note('The capture had no meshes of expressions: the head does not move.');
  }

  buildPanel() {
    byId('panel').hidden = false;
    const has = (mode) => (mode !== 'masks' || this.masks.length) && (mode !== 'regions' || this.description.regions?.length);
    const shown = Object.keys(modes).filter(has);
    options(byId('mode'), shown.map((mode) => modes[mode]), shown);
    options(byId('map'), this.description.maps.map((map) => map.name));
    options(byId('layer'), Array.from({ length: this.description.differences }, (_, i) => String(i)));
    for (const id of ['mode', 'map', 'layer']) byId(id).addEventListener('change', () => this.showMode());
    byId('flat').disabled = !this.description.mesh;
    byId('flat').checked = !this.description.mesh;
    byId('flat').addEventListener('change', () => this.showMode());
    byId('turn').addEventListener('change', (event) => { this.head.controls.autoRotate = event.target.checked; });
    byId('detail').addEventListener('change', (event) => {
      this.uniforms.detail.value = event.target.checked;
      this.changed = true;
    });
    options(byId('preset'), ['choose', ...this.names], ['', ...this.names]);
    byId('preset').addEventListener('change', (event) => {
      if (event.target.value) this.setWeights({ [event.target.value]: 1 });
    });
    byId('random').addEventListener('click', () => this.randomise());
    byId('neutral').addEventListener('click', () => this.setWeights({}));
    this.sliders = this.names.map((name, n) => slider(byId('expressions'), name, 0, 1, 0, (value) => {
      this.weights[n] = value;
      this.stopClip();
      this.changed = true;
    }));
    byId('filter').addEventListener('input', (event) => filterRows(this.sliders, event.target.value));
    this.buildGains();
    this.buildClip();
  }

  buildGains() {
    const rows = (id, names, values) => names.map((name, i) => slider(byId(id), name, 0, 3, 1, (value) => {
      values()[i] = value;
      this.applyGains();
    }));
    const regions = (this.description.regions ?? []).map((region) => region.name);
    this.gainSliders = rows('gains', this.names, () => this.gains.expressions);
    this.regionSliders = rows('regions', regions, () => this.gains.regions);
    byId('region-section').hidden = !regions.length;
    byId('save').addEventListener('click', () =>
      download('gains.json', `${JSON.stringify(this.preset(), null, 2)}\n`));
    byId('reset').addEventListener('click', () => this.setGains(unitGains(this.description)));
    onFile(byId('load'), (text, name) => {
      this.setGains(fromPreset(this.description, text));
      note(`${name} is in force`);
    });
  }

  buildClip() {
    onFile(byId('clip'), (text, name) => {
      const { frames, notes } = readClip(text, this.names);
      this.clip = { frames, time: 0, playing: true };
      byId('play').hidden = byId('rate-row').hidden = false;
      byId('play').textContent = 'Pause';
      note([`${name}: ${frames.length} frames`, ...notes].join('; '));
    });
    byId('play').addEventListener('click', () => {
      this.clip.playing = !this.clip.playing;
      byId('play').textContent = this.clip.playing ? 'Pause' : 'Play';
    });
  }

  stopClip() {
    if (!this.clip) return;
    this.clip.playing = false;
    byId('play').textContent = 'Play';
  }

  advanceClip(seconds) {
    if (!this.clip?.playing) return;
    const { frames } = this.clip;
    this.clip.time += seconds * (Number(byId('rate').value) || 30);
    this.showWeights(frames[Math.floor(this.clip.time) % frames.length]);
  }

  showWeights(weights) {
    this.weights.set(weights);
    this.sliders.forEach((row, n) => row.set(weights[n]));
    this.changed = true;
  }

  /** Weights by name; others are 0. */
  setWeights(byName) {
    this.stopClip();
    for (const name of Object.keys(byName)) {
      if (!this.names.includes(name)) throw new Error(`the package has no expression "${name}"`);
    }
    this.showWeights(this.names.map((name) => byName[name] ?? 0));
  }

  randomise() {
    const weights = {};
    const count = 1 + Math.floor(Math.random() * 4);
    for (let i = 0; i < count; ++i) weights[this.names[Math.floor(Math.random() * this.names.length)]] = Math.random();
    this.setWeights(weights);
  }

  preset() { return toPreset(this.description, this.gains); }

  setGains(gains) {
    this.gains = gains;
    this.gainSliders.forEach((row, n) => row.set(gains.expressions[n]));
    this.regionSliders.forEach((row, r) => row.set(gains.regions[r]));
    this.applyGains();
  }

  applyGains() {
    this.textures.sets.forEach((set, s) =>
      set.setGains(cellGains(this.description, this.masks, this.gains.regions, this.description.weights[s])));
    this.changed = true;
  }

  showMode() {
    const mode = byId('mode').value;
    const map = this.textures.maps[byId('map').selectedIndex];
    byId('detail-row').hidden = mode !== 'shaded' || !mapOfRole(this.textures, 'normal');
    showLegend(legends[mode]);
    byId('map-row').hidden = ['shaded', 'masks', 'regions'].includes(mode);
    byId('layer-row').hidden = !['difference', 'weights'].includes(mode);
    this.uniforms.layer.value = Number(byId('layer').value);
    if (mode === 'masks' || mode === 'regions') {
      this.uniforms.picture.value?.dispose();
      const groups = mode === 'masks' ? this.masks.map((_, k) => [k]) : this.description.regions.map((region) => region.masks);
      this.uniforms.picture.value = maskPicture(this.description, this.masks, groups);
    }
    const view = mode === 'masks' || mode === 'regions' ? 'picture' : mode;
    this.head.setMaterial(mode === 'shaded'
      ? shadedMaterial(this.textures, this.uniforms) : viewMaterial(this.textures, map, view, this.uniforms), mode === 'shaded');
    const flat = byId('flat').checked;
    const aspect = map.width / map.height;
    if (flat !== this.flat || aspect !== this.aspect) this.head.show(flat, aspect);
    Object.assign(this, { flat, aspect, changed: true });
  }

  resize() {
    const panel = byId('panel').getBoundingClientRect();
    // Beside the panel, or above it where it spans the window.
    if (panel.left > 0) this.head.resize(panel.left, window.innerHeight);
    else this.head.resize(window.innerWidth, panel.top);
    this.changed = true;
  }

  /** Blends, where weights or gains changed. */
  update() {
    if (!this.changed) return;
    this.changed = false;
    this.textures.blend(this.head.renderer, this.weights.map((weight, n) => weight * this.gains.expressions[n]));
    this.head.setMorphs(this.names, this.weights);
  }

  run() {
    let last = performance.now();
    let frames = 0;
    let since = last;
    const frame = (now) => {
      this.advanceClip((now - last) / 1000);
      last = now;
      // A still head costs nothing: what is drawn is what changed.
      const moved = this.head.controls.update();
      if (this.changed || moved) {
        try {
          this.update();
          this.head.render();
        } catch (error) {
          fail(error.message);
          throw error;
        }
        ++frames;
      } else if (!frames) {
        since = now;
      }
      if (frames && now - since > 500) {
        const rate = ((frames * 1000) / (now - since)).toFixed(0);
        byId('stats').textContent = `${rate} frames/s   ${(memory.bytes / 1e6).toFixed(1)} MB of textures and mesh on the GPU`;
        frames = 0;
        since = now;
      }
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }
}

const viewer = new Viewer();
// For scripts and tests: set weights, read what the shader computes.
globalThis.facezip = {
  ready: viewer.load().then(() => viewer.run()),
  get expressions() { return viewer.names; },
  get morphs() { return viewer.morphs; },
  setWeights: (byName) => viewer.setWeights(byName),
  setPreset: (text) => viewer.setGains(fromPreset(viewer.description, text)),
  get preset() { return viewer.preset(); },
  /** Names of the parts beyond the skin, those that are seen. */
  get parts() { return (viewer.head.parts ?? []).filter((part) => part.visible).map((part) => part.material.name); },
  /** How far each of them is posed, by names of expressions. */
  get partWeights() {
    return (viewer.head.parts ?? []).map(({ morphTargetDictionary: index, morphTargetInfluences: pose }) =>
      Object.fromEntries(Object.entries(index ?? {}).map(([name, i]) => [name, pose[i]])));
  },
  get gpuBytes() { return memory.bytes; },
  /** What is shown is up to date. */
  get settled() { return viewer.changed === false; },
  /** RGBA bytes, row 0 first, of map `index`. */
  bake(index) {
    viewer.update();
    return viewer.textures.bake(viewer.head.renderer, index);
  },
};
globalThis.facezip.ready.catch((error) => {
  fail(error.message);
  console.error(error);
});
