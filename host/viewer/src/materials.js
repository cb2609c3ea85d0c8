// Materials of the head: shaded with every map that has a place in a physical material, and views for a look inside.
import * as THREE from 'three';
import table from '../../data/map_roles.json';
import { blendHeader } from './blend.js';

// Tangent frame from derivatives, since captures carry no tangents; v of textures runs down, +y of normal maps up.
const tangentFrame = `
  vec3 fz_perturb(vec3 position, vec3 surface, vec2 uv, vec3 mapped) {
    vec3 dx = dFdx(position), dy = dFdy(position);
    vec2 du = dFdx(uv), dv = dFdy(uv);
    vec3 across = cross(dy, surface), along = cross(surface, dx);
    vec3 tangent = across * du.x + along * dv.x;
    vec3 bitangent = -(across * du.y + along * dv.y);
    float size = max(dot(tangent, tangent), dot(bitangent, bitangent));
    float factor = size == 0.0 ? 0.0 : inversesqrt(size);
    return normalize(tangent * factor * mapped.x + bitangent * factor * mapped.y + surface * mapped.z);
  }`;

const toLinear = 'vec3 fz_linear(vec3 c) { return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, vec3(lessThanEqual(c, vec3(0.04045)))); }';

// Eyes and mouth are holes: what is seen through them is dark.
const inside = 'if (!gl_FrontFacing) diffuseColor.rgb *= 0.04;';

/** Gives a material of three.js a varying with UVs, whatever textures it has. */
function withUvs(shader) {
  shader.vertexShader = shader.vertexShader
    .replace('#include <common>', '#include <common>\nvarying vec2 fz_uv;')
    .replace('#include <uv_vertex>', '#include <uv_vertex>\nfz_uv = uv;');
}

/** "T_BaseColorMap2" gives t, base, color, map; "AOMap" gives ao, map. */
const wordsOf = (name) => (name.match(/[A-Z]+(?![a-z])|[A-Z]?[a-z]+/g) ?? []).map((word) => word.toLowerCase());

/** A word of six letters or more anywhere, or one or several words of the name in a row. */
const holds = (words, entry) => (entry.length >= 6 && words.join('').includes(entry)) ||
  words.some((_, first) => words.some((__, last) => last >= first && words.slice(first, last + 1).join('') === entry));

/** What a map is in a physical material, by its name: as exports have it (host/src/export/map_roles.cpp). */
export function roleOf(name) {
  const words = wordsOf(name);
  return table.roles.find((entry) => entry.words.some((word) => holds(words, word)) &&
    !entry.not.some((word) => holds(words, word)))?.role;
}

/** The first map of a role has it. */
export function mapOfRole({ maps }, role) {
  return maps.find(({ name }) => roleOf(name) === role);
}

/** Albedo (or the first map), normal, roughness and occlusion, blended in one shader. uniforms.detail switches the normal
 * map. */
export function shadedMaterial(textures, uniforms) {
  const albedo = mapOfRole(textures, 'albedo') ?? textures.maps[0];
  const normal = mapOfRole(textures, 'normal');
  const roughness = mapOfRole(textures, 'roughness');
  const occlusion = mapOfRole(textures, 'occlusion');
  const declarations = `${blendHeader(textures.differences)} ${tangentFrame} ${toLinear}
    ${albedo.source('albedo')} ${normal?.source('normal') ?? ''} ${roughness?.source('roughness') ?? ''}
    ${occlusion?.source('occlusion') ?? ''}`;
  const stored = 'clamp(albedo_value(fz_uv).rgb, 0.0, 1.0)';
  const colour = albedo.linear ? stored : `fz_linear(${stored})`;
  const material = new THREE.MeshStandardMaterial({ roughness: 0.55, side: THREE.DoubleSide });
  material.onBeforeCompile = (shader) => {
    withUvs(shader);
    Object.assign(shader.uniforms, uniforms, albedo.uniformsAs('albedo'), normal?.uniformsAs('normal'),
      roughness?.uniformsAs('roughness'), occlusion?.uniformsAs('occlusion'));
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>
        varying vec2 fz_uv;
        uniform bool detail;
        ${declarations}`)
      .replace('#include <map_fragment>', `diffuseColor.rgb = ${colour};
        ${inside}`);
    if (normal) {
      shader.fragmentShader = shader.fragmentShader.replace('#include <normal_fragment_maps>', `
        if (detail) normal = fz_perturb(-vViewPosition, normal, fz_uv, normal_value(fz_uv).xyz * 2.0 - 1.0);`);
    }
    if (roughness) {
      shader.fragmentShader = shader.fragmentShader.replace('#include <roughnessmap_fragment>',
        'float roughnessFactor = clamp(roughness_value(fz_uv).r, 0.05, 1.0);');
    }
    if (occlusion) {
      shader.fragmentShader = shader.fragmentShader.replace('#include <aomap_fragment>',
        'reflectedLight.indirectDiffuse *= clamp(occlusion_value(fz_uv).r, 0.0, 1.0);');
    }
  };
  // By itself three.js compares the text of onBeforeCompile, and would draw a second face with the first one's program.
  material.customProgramCacheKey = () => `${declarations} ${colour}`;
  return material;
}

// What a view shows; `layer` picks a difference texture or a weight channel.
const views = {
  texture: 'map_value(fz_uv).rgb',
  neutral: 'texture(map_neutral, fz_uv).rgb',
  difference: `0.5 + (texture(map_differences, vec3(fz_uv, float(layer))) - map_zero[layer]).rgb * map_scale[layer].rgb`,
  weights: `signed_colour(layer < 4 ? map_weights(fz_uv, 0)[layer] : map_weights(fz_uv, 1)[layer - 4])`,
  change: 'heat(length(map_change(fz_uv).rgb) * 255.0 / 60.0)',
  picture: 'texture(picture, fz_uv).rgb',
};

const colours = `
  vec3 signed_colour(float w) {
    return w < 0.0 ? mix(vec3(1.0), vec3(0.1, 0.2, 0.8), min(-w, 1.0)) : mix(vec3(1.0), vec3(0.8, 0.15, 0.05), min(w, 1.0));
  }
  vec3 heat(float t) {
    t = clamp(t, 0.0, 1.0);
    return clamp(vec3(3.0 * t, 3.0 * t - 1.0, 3.0 * t - 2.0), 0.0, 1.0);
  }`;

/** What the colours of a view mean: the scales of `colours`. */
export const legends = {
  weights: { least: '-1', colours: 'linear-gradient(90deg, rgb(26 51 204), #fff, rgb(204 38 13))', most: '1' },
  change: { least: '0', colours: 'linear-gradient(90deg, #000, #f00, #ff0, #fff)', most: '60/255' },
};

/** Unlit: one of `views`, of one map. */
export function viewMaterial(textures, map, view, uniforms) {
  const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, toneMapped: false });
  const expression = map.set.groups > 1 ? views[view] : views[view].replace(/layer < 4 \? (.*?) : .*\)$/, '$1)');
  material.onBeforeCompile = (shader) => {
    withUvs(shader);
    Object.assign(shader.uniforms, uniforms, map.uniformsAs('map'));
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>
        varying vec2 fz_uv;
        uniform int layer;
        ${view === 'picture' ? 'uniform sampler2D picture;' : ''}
        ${blendHeader(textures.differences)} ${colours} ${map.source('map')}`)
      .replace('#include <map_fragment>', `diffuseColor.rgb = ${expression};
        ${inside}`)
      .replace('#include <colorspace_fragment>', '');  // the values themselves
  };
  material.customProgramCacheKey = () => `${map.name} ${view}`;
  return material;
}

/** A colour for each of `groups` of masks, mixed by the masks: rows x columns RGBA bytes as a texture. */
export function maskPicture(description, masks, groups) {
  const { tile_width: width, tile_height: height } = description.masks;
  const data = new Uint8Array(4 * width * height);
  const sums = new Float32Array(3 * width * height);
  groups.forEach((group, g) => {
    const colour = new THREE.Color().setHSL((g * 0.61803) % 1, 0.75, g % 2 ? 0.45 : 0.6, THREE.LinearSRGBColorSpace);
    for (const k of group) {
      masks[k].forEach((mask, q) => {
        sums[3 * q] += mask * colour.r;
        sums[3 * q + 1] += mask * colour.g;
        sums[3 * q + 2] += mask * colour.b;
      });
    }
  });
  for (let q = 0; q < width * height; ++q) {
    for (let c = 0; c < 3; ++c) data[4 * q + c] = Math.min(255, Math.round(255 * sums[3 * q + c]));
    data[4 * q + 3] = 255;
  }
  const texture = new THREE.DataTexture(data, width, height);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
