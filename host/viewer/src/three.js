// For pages with three.js of their own: a face whose mesh and textures follow one set of weights.
//   import { loadFace } from './facezip_three.js';
//   const face = await loadFace(renderer, './');   // the folder that holds `package`
//   scene.add(face.object);
//   face.setWeights({ smile: 0.7 });               // whenever they change; blends on the GPU
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { PackageTextures } from './blend.js';
import { composeTargets } from './composed.js';
import { fileReader } from './files.js';
import { cellGains, fromPreset } from './gains.js';
import { shadedMaterial } from './materials.js';
import { readDescription, readMasks } from './package.js';
import { loadParts, setMorphs } from './parts.js';

export async function loadFace(renderer, base = './') {
  if (!renderer.extensions.has('EXT_color_buffer_float')) throw new Error('facezip needs EXT_color_buffer_float');
  const readFile = fileReader(base);  // the face's own: others may load meanwhile, and gains read masks later
  const description = await readDescription(readFile);
  const textures = await PackageTextures.load(readFile, description, renderer, () => {});
  const gltf = await new GLTFLoader().parseAsync((await readFile(description.mesh.file)).buffer, '');
  let object;
  gltf.scene.traverse((node) => { if (node.isMesh) object = node; });
  composeTargets(object);
  const parts = await loadParts(readFile, description);
  for (const part of parts) object.add(part);
  object.material = shadedMaterial(textures, { detail: { value: true } });
  let gains = new Float32Array(description.expressions.length).fill(1);
  let weights = new Float32Array(description.expressions.length);
  const blend = () => textures.blend(renderer, weights.map((weight, n) => weight * gains[n]));
  blend();
  return {
    object,
    textures,
    expressions: description.expressions,
    /** Weights by name; others are 0. */
    setWeights(byName) {
      weights = Float32Array.from(description.expressions, (name) => byName[name] ?? 0);
      setMorphs([object, ...parts], (name) => byName[name]);
      blend();
    },
    /** The text of a preset of gains that `facezip view` saved. */
    async setGains(text) {
      const preset = fromPreset(description, text);
      const masks = await readMasks(readFile, description);
      gains = preset.expressions;
      textures.sets.forEach((set, s) => set.setGains(cellGains(description, masks, preset.regions, description.weights[s])));
      blend();
    },
  };
}
