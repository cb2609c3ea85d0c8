// The blend on the GPU: weight maps and textures of a package as texture arrays, and host/shaders/facezip_blend.h.
import * as THREE from 'three';
import blendSource from '../../shaders/facezip_blend.h';
import { inBlocks, readBlockArray, readBlockTexture, requireBlocks } from './block_textures.js';
import { readImage, toRgba } from './images.js';
import { readWeights } from './package.js';

/** Counts bytes of textures on the GPU: blocks as they are, images as RGBA, mip levels included. */
export const memory = { bytes: 0 };

function prepare(texture, bytes, mipmaps) {
  texture.colorSpace = THREE.NoColorSpace;
  texture.flipY = false;
  texture.unpackAlignment = 1;
  texture.wrapS = texture.wrapT = THREE.ClampToEdgeWrapping;
  texture.generateMipmaps = mipmaps;
  texture.magFilter = mipmaps ? THREE.LinearFilter : THREE.NearestFilter;
  texture.minFilter = mipmaps ? THREE.LinearMipmapLinearFilter : THREE.NearestFilter;
  texture.needsUpdate = true;
  memory.bytes += mipmaps ? Math.round((bytes * 4) / 3) : bytes;
  return texture;
}

/** Images of one size as layers of a texture array; `filtered`: with mip levels. */
function arrayTexture(images, filtered, floatsFilter) {
  const { width, height } = images[0];
  const bytes = images.every((image) => image.most === 255);
  const layer = 4 * width * height;
  const data = new (bytes ? Uint8Array : Float32Array)(layer * images.length);
  images.forEach((image, i) => toRgba(image, data, i * layer));
  const texture = new THREE.DataArrayTexture(data, width, height, images.length);
  texture.type = bytes ? THREE.UnsignedByteType : THREE.FloatType;
  return prepare(texture, data.byteLength, filtered && (bytes || floatsFilter));
}

const quadVertex = 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }';

/** Runs a fragment shader over a render target. */
class Pass {
  constructor(fragment, uniforms, defines) {
    this.material = new THREE.ShaderMaterial({ glslVersion: THREE.GLSL3, vertexShader: quadVertex, fragmentShader: fragment,
      uniforms, defines, depthTest: false, depthWrite: false });
    this.scene = new THREE.Scene();
    const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.material);
    quad.frustumCulled = false;
    this.scene.add(quad);
    this.camera = new THREE.Camera();
  }
  run(renderer, target) {
    const before = renderer.getRenderTarget();
    renderer.setRenderTarget(target);
    renderer.render(this.scene, this.camera);
    renderer.setRenderTarget(before);
  }
}

/** One set of weight maps; step 1 of the header into `grid`. */
class WeightSet {
  static async load(readFile, description, set) {
    return new WeightSet(description, set, await readWeights(readFile, description, set));
  }
  constructor(description, set, layers) {
    const expressions = description.expressions.length;
    this.columns = set.tile_width;
    this.rows = set.tile_height;
    this.groups = set.files.length;
    const vectors = (values) =>
      Array.from({ length: this.groups }, (_, g) => new THREE.Vector4(...[0, 1, 2, 3].map((i) => values[4 * g + i] ?? 0)));
    this.gains = new THREE.DataTexture(new Float32Array(4 * this.columns * this.rows).fill(1), this.columns, this.rows,
      THREE.RGBAFormat, THREE.FloatType);
    prepare(this.gains, this.gains.image.data.byteLength, false);
    this.grid = new THREE.WebGLRenderTarget(this.columns, this.rows * this.groups, { type: THREE.FloatType,
      minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: false });
    memory.bytes += 16 * this.columns * this.rows * this.groups;
    this.beta = new Float32Array(expressions);
    this.pass = new Pass(`
      precision highp sampler2DArray;
      uniform float fz_beta[EXPRESSIONS];
      ${blendSource}
      uniform sampler2DArray layers;
      uniform sampler2D gains;
      uniform vec4 scales[GROUPS];
      uniform vec4 offsets[GROUPS];
      layout(location = 0) out vec4 weights;
      void main() {
        int row = int(gl_FragCoord.y);
        ivec2 cell = ivec2(int(gl_FragCoord.x), row % ROWS);
        int group = row / ROWS;
        weights = fz_blend_weights(layers, cell, EXPRESSIONS, GROUPS, group, scales[group] * 255.0, offsets[group],
                                   texelFetch(gains, cell, 0).r);
      }`,
      { fz_beta: { value: this.beta }, layers: { value: arrayTexture(layers, false, false) }, gains: { value: this.gains },
        scales: { value: vectors(set.scale) }, offsets: { value: vectors(set.offset) } },
      { EXPRESSIONS: expressions, GROUPS: this.groups, ROWS: this.rows });
  }
  setGains(cells) {
    cells.forEach((gain, q) => this.gains.image.data.fill(gain, 4 * q, 4 * q + 4));
    this.gains.needsUpdate = true;
  }
  blend(renderer, beta) {
    this.beta.set(beta);
    this.pass.run(renderer, this.grid);
  }
}

/** Blocks go to the GPU as they are. */
function counted({ texture, bytes }) {
  memory.bytes += bytes;
  return texture;
}

async function loadNeutral(readFile, map, floatsFilter) {
  if (inBlocks(map.neutral)) return counted(await readBlockTexture(readFile, map.neutral, map));
  const image = await readImage(readFile, map.neutral.file);
  const bytes = image.most === 255;
  const data = toRgba(image, new (bytes ? Uint8Array : Float32Array)(4 * map.width * map.height));
  const texture = new THREE.DataTexture(data, map.width, map.height, THREE.RGBAFormat,
    bytes ? THREE.UnsignedByteType : THREE.FloatType);
  return prepare(texture, data.byteLength, bytes || floatsFilter);
}

async function loadDifferences(readFile, map, floatsFilter) {
  if (inBlocks(map.differences[0])) return counted(await readBlockArray(readFile, map.differences, map));
  const images = [];
  for (const difference of map.differences) images.push(await readImage(readFile, difference.file));
  return arrayTexture(images, true, floatsFilter);
}

/** One map: three samplers, whatever C is: neutral, differences, weights. */
class MapTextures {
  static async load(readFile, map, set, renderer) {
    requireBlocks(map, renderer);
    const floatsFilter = renderer.extensions.has('OES_texture_float_linear');
    return new MapTextures(map, set, await loadNeutral(readFile, map, floatsFilter),
      await loadDifferences(readFile, map, floatsFilter));
  }
  constructor(map, set, neutral, differences) {
    Object.assign(this, { name: map.name, width: map.width, height: map.height, set, count: map.differences.length,
      linear: map.colour_space === 'linear' });
    const most = (1 << map.difference_bits) - 1;
    const perTexture = (value) => map.differences.map((difference) => {
      const channel = (c) => (c < map.channels ? value(difference.scale[c], difference.offset[c]) : 0);
      return new THREE.Vector4(channel(0), channel(1), channel(2), channel(3));
    });
    this.uniforms = {
      neutral: { value: neutral },
      differences: { value: differences },
      grid: { value: set.grid.texture },
      zero: { value: perTexture((scale, offset) => (scale > 0 ? Math.round(-offset / scale) / most : 0)) },
      scale: { value: perTexture((scale) => (scale * most) / 255) },
      size: { value: new THREE.Vector2(map.width, map.height) },
      cells: { value: new THREE.Vector2(set.columns, set.rows) },
      weight_scale: { value: map.weight_scale },
    };
    this.single = map.channels < 3;  // gray
  }

  /** Uniforms under names of their own, and GLSL: PREFIX_value(uv) is T, PREFIX_change(uv) the differences' sum. */
  uniformsAs(prefix) {
    return Object.fromEntries(Object.entries(this.uniforms).map(([name, uniform]) => [`${prefix}_${name}`, uniform]));
  }
  source(prefix) {
    const p = prefix;
    return `
      uniform sampler2D ${p}_neutral, ${p}_grid;
      uniform sampler2DArray ${p}_differences;
      uniform vec4 ${p}_zero[FZ_DIFFERENCES], ${p}_scale[FZ_DIFFERENCES];
      uniform vec2 ${p}_size, ${p}_cells;
      uniform float ${p}_weight_scale;
      vec4 ${p}_weights(vec2 uv, int group) {
        return fz_weights(${p}_grid, fz_cell(uv, ${p}_size, ${p}_weight_scale, ${p}_cells), ${p}_cells, group);
      }
      vec4 ${p}_change(vec2 uv) {
        vec4 low = ${p}_weights(uv, 0);
        vec4 high = ${this.set.groups > 1 ? `${p}_weights(uv, 1)` : 'vec4(0.0)'};
        return fz_difference(${p}_differences, uv, low, high, ${p}_zero, ${p}_scale);
      }
      vec4 ${p}_value(vec2 uv) {
        vec4 value = texture(${p}_neutral, uv) + ${p}_change(uv);
        return ${this.single ? 'vec4(value.rrr, 1.0)' : 'value'};
      }`;
  }
}

/** The header, once per shader; every map of a package has the same C. */
export function blendHeader(differences) {
  return `precision highp sampler2DArray;
    #define FZ_DIFFERENCES ${differences}
    #define FZ_BETA(n) 0.0
    ${blendSource}`;
}

/** Throws an Error where the package wants more of the graphics driver than it takes. */
function requireLimits(description, renderer) {
  const gl = renderer.getContext();
  const require = (item, most, what, got, cure) => {
    if (got > most) throw new Error(`${item}: expected at most ${most} (${what}), got ${got}: ${cure}`);
  };
  const expressions = (most, what) => require('expressions', most, what, description.expressions.length, 'compress fewer expressions');
  const groups = Math.max(...description.weights.map((set) => set.files.length));
  const layers = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
  expressions(Math.floor(layers / groups), `this graphics driver takes ${layers} layers in a texture array`);
  // fz_beta takes a vector for each of its floats; scales and offsets take their own.
  const vectors = gl.getParameter(gl.MAX_FRAGMENT_UNIFORM_VECTORS);
  expressions(vectors - 2 * groups, `this graphics driver takes ${vectors} uniform vectors in a fragment shader`);
  const side = Math.max(...description.maps.flatMap((map) => [map.width, map.height]));
  require('textures', gl.getParameter(gl.MAX_TEXTURE_SIZE), 'texels a side that this graphics driver takes', side,
    'compress smaller textures');
}

/** All maps of a package on the GPU. */
export class PackageTextures {
  static async load(readFile, description, renderer, progress) {
    requireLimits(description, renderer);
    const textures = new PackageTextures();
    textures.differences = description.differences;
    textures.sets = [];
    textures.maps = [];
    for (const set of description.weights) {
      progress('weight maps');
      textures.sets.push(await WeightSet.load(readFile, description, set));
    }
    for (const map of description.maps) {
      progress(map.name);
      textures.maps.push(await MapTextures.load(readFile, map, textures.sets[map.weights], renderer));
    }
    return textures;
  }

  blend(renderer, beta) {
    for (const set of this.sets) set.blend(renderer, beta);
  }

  /** The blended texture, height x width x RGBA bytes, row 0 first: what the shaders compute at texel centres. */
  bake(renderer, index) {
    const map = this.maps[index];
    const target = new THREE.WebGLRenderTarget(map.width, map.height, { depthBuffer: false });
    const pass = new Pass(`
      #define FZ_SAMPLE_LAYER(t, uv, layer) texelFetch(t, ivec3(gl_FragCoord.xy, layer), 0)
      ${blendHeader(this.differences)}
      ${map.source('map').replace('texture(map_neutral, uv)', 'texelFetch(map_neutral, ivec2(gl_FragCoord.xy), 0)')}
      layout(location = 0) out vec4 colour;
      void main() { colour = map_value(gl_FragCoord.xy / map_size); }`, map.uniformsAs('map'));
    pass.run(renderer, target);
    const pixels = new Uint8Array(4 * map.width * map.height);
    renderer.readRenderTargetPixels(target, 0, 0, map.width, map.height, pixels);
    target.dispose();
    pass.material.dispose();
    return pixels;
  }
}
