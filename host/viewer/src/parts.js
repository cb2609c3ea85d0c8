// Eyes, teeth, lashes: parts of a head whose texture does not change, with materials of their own (docs/package_format.md).
import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { memory } from './blend.js';
import { composeTargets } from './composed.js';
import { readImage, toRgba } from './images.js';

/** The texture of a material. A gray image with alpha is white where it is 255, and so on: three.js knows RGBA alone. */
async function loadTexture(readFile, { file, channels }) {
  const image = await readImage(readFile, file);
  const data = toRgba(image, new Uint8Array(4 * image.width * image.height));
  for (let i = 0; i < data.length; i += 4) {
    if (channels < 3) {
      data[i + 3] = channels === 2 ? data[i + 1] : 255;
      data[i + 1] = data[i + 2] = data[i];
    } else if (channels === 3) {
      data[i + 3] = 255;
    }
  }
  const texture = new THREE.DataTexture(data, image.width, image.height);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.magFilter = THREE.LinearFilter;
  texture.minFilter = THREE.LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  memory.bytes += Math.round((data.length * 4) / 3);
  return texture;
}

async function loadMaterial(readFile, { name, colour, opacity, alpha, roughness, texture }) {
  const blended = alpha === 'blend';
  const material = new THREE.MeshStandardMaterial({ name, roughness, opacity, transparent: blended, depthWrite: !blended,
    alphaTest: alpha === 'mask' ? 0.5 : 0, side: blended ? THREE.FrontSide : THREE.DoubleSide,
    map: texture ? await loadTexture(readFile, texture) : null });
  material.color.setRGB(...colour, THREE.LinearSRGBColorSpace);
  return material;
}

/** The parts of a package as meshes; none where it has none. */
export async function loadParts(readFile, { parts }) {
  if (!parts) return [];
  const gltf = await new GLTFLoader().parseAsync((await readFile(parts.file)).buffer, '');
  const meshes = [];
  gltf.scene.traverse((node) => { if (node.isMesh) meshes.push(node); });
  const materials = await Promise.all(parts.materials.map((material) => loadMaterial(readFile, material)));
  meshes.forEach((mesh, p) => {
    composeTargets(mesh);
    mesh.material.dispose();
    mesh.material = materials[p];
    mesh.frustumCulled = false;
    const { position } = mesh.geometry.attributes;
    const targets = mesh.geometry.morphAttributes.position?.length ?? 0;
    memory.bytes += position.count * 32 * (1 + targets) + (mesh.geometry.index?.count ?? 0) * 4;
  });
  return meshes;
}

/** Poses meshes by weights of expressions, by name. */
export function setMorphs(meshes, weightOf) {
  for (const mesh of meshes) {
    for (const [name, index] of Object.entries(mesh.morphTargetDictionary ?? {})) {
      mesh.morphTargetInfluences[index] = weightOf(name) ?? 0;
    }
  }
}
