// What the exports for Unity and Unreal compute: their HLSL by glslang and SPIRV-Cross as WebGL 2, drawn in Chromium.
//   node hlsl_test.mjs FACEZIP CHROMIUM GLSLANG SPIRV_CROSS PACKAGES WORK_DIRECTORY
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { decode, encode } from 'fast-png';
import { read } from 'ktx-parse';
import { blendDifference, launch, openPage, results, run } from './common.mjs';

const [facezip, browserPath, glslang, spirvCross, packages, work] = process.argv.slice(2);
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });

/** HLSL of a shader that writes T of a map at texel centres, as each engine's file computes it. */
const shaders = {
  unity: (folder, node, { width, height }) => `#include "FaceZip.hlsl"
float4 main(float4 place : SV_Position) : SV_Target {
  float4 value;
  FaceZip_${node.map}_float(place.xy / float2(${width}.0, ${height}.0), value);
  return value;
}`,
  unreal: (folder, node, { width, height }, count) => `${readFileSync(join(folder, 'FaceZip.ush'))}
${node.textures.map((name) => `Texture2D<float4> ${name};`).join('\n')}
SamplerState state;
float fz_given[${count}];
float4 main(float4 place : SV_Position) : SV_Target {
  FaceZipBlend face;
  for (int n = 0; n < ${count}; ++n) face.fz_beta[n] = fz_given[n];
  return face.facezip_${node.map}(place.xy / float2(${width}.0, ${height}.0), state, ${node.textures.join(', ')});
}`,
};

function toGlsl(folder, name, hlsl) {
  const file = join(folder, name);
  writeFileSync(`${file}.hlsl`, hlsl);
  execFileSync(glslang, ['-D', '-e', 'main', '-S', 'frag', '-V', '--auto-map-bindings', '--auto-map-locations', '-o', `${file}.spv`, `${file}.hlsl`],
    { stdio: ['ignore', 'ignore', 'inherit'] });
  return execFileSync(spirvCross, [`${file}.spv`, '--es', '--version', '300'], { encoding: 'utf8' });
}

/** RGBA bytes as importers make them: gray in three channels. Rows from the top, or from the bottom as Unity has them. */
function readTexture(file, fromBottom) {
  const { width, height, channels, data } = decode(readFileSync(file));
  const rgba = Buffer.alloc(4 * width * height, 255);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const from = ((fromBottom ? height - 1 - y : y) * width + x) * channels;
      const to = 4 * (y * width + x);
      for (let c = 0; c < 3; ++c) rgba[to + c] = data[from + (channels < 3 ? 0 : c)];
      if (channels === 2 || channels === 4) rgba[to + 3] = data[from + channels - 1];
    }
  }
  return { width, height, text: rgba.toString('latin1') };
}

const blockFormats = { 131: 'COMPRESSED_RGB_S3TC_DXT1_EXT', 139: 'COMPRESSED_RED_RGTC1_EXT', 141: 'COMPRESSED_RED_GREEN_RGTC2_EXT',
  145: 'COMPRESSED_RGBA_BPTC_UNORM_EXT', 161: 'COMPRESSED_RGBA_ASTC_5x5_KHR' };

/** A texture of the folder as the engine has it: an image, or the blocks of a KTX2 file as they are. */
function engineTexture(folder, name, fromBottom) {
  const blocks = join(folder, 'textures', `${name}.fzktx2`);
  if (!existsSync(blocks)) return readTexture(join(folder, 'textures', `${name}.png`), fromBottom);
  const { pixelWidth, pixelHeight, vkFormat, levels } = read(readFileSync(blocks));
  return { width: pixelWidth, height: pixelHeight, format: blockFormats[vkFormat], text: Buffer.from(levels[0].levelData).toString('latin1') };
}

/** In the page: draws the shader, reads its pixels, row 0 first as gl_FragCoord counts. */
function draw({ glsl, textures, weights, width, height }) {
  const gl = new OffscreenCanvas(width, height).getContext('webgl2', { premultipliedAlpha: false });
  const program = gl.createProgram();
  const vertex = '#version 300 es\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }';
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, glsl]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const extensions = ['WEBGL_compressed_texture_s3tc', 'EXT_texture_compression_rgtc', 'EXT_texture_compression_bptc',
    'WEBGL_compressed_texture_astc'].map((name) => gl.getExtension(name));
  const blockFormat = (name) => extensions.find((extension) => extension?.[name])[name];
  const bytes = (text) => Uint8Array.from(text, (c) => c.charCodeAt(0));
  Object.entries(textures).forEach(([name, texture], unit) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    if (texture.format) {
      gl.compressedTexImage2D(gl.TEXTURE_2D, 0, blockFormat(texture.format), texture.width, texture.height, 0, bytes(texture.text));
    } else {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, texture.width, texture.height, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes(texture.text));
    }
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    // SPIRV-Cross names what it combines after texture and sampler.
    const found = glsl.match(new RegExp(`SPIRV_Cross_Combined${name}(?!\\d)\\w+`));
    if (!found) throw new Error(`${name} is not read`);
    gl.uniform1i(gl.getUniformLocation(program, found[0]), unit);
  });
  // std140: every float of an array takes 16 bytes.
  gl.uniformBlockBinding(program, gl.getUniformBlockIndex(program, '_Global'), 0);
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, gl.createBuffer());
  gl.bufferData(gl.UNIFORM_BUFFER, Float32Array.from({ length: 4 * weights.length }, (_, i) => (i % 4 ? 0 : weights[i / 4])), gl.STATIC_DRAW);
  gl.viewport(0, 0, width, height);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return Array.from(pixels, (byte) => String.fromCharCode(byte)).join('');
}

/** Maps of one and two channels, which get BC4 and BC5. */
function grayPackage() {
  const [images, blocks] = ['gray_images', 'gray_blocks'].map((name) => join(work, name));
  cpSync(join(packages, 'head'), images, { recursive: true });
  const description = JSON.parse(readFileSync(join(images, 'package.json')));
  const albedo = description.maps.find((map) => map.name === 'albedo');
  const maps = [1, 2].map((channels) => {
    const reduced = (file) => {
      const { width, height, data, ...image } = decode(readFileSync(join(images, file)));
      const to = file.replace('.png', `_${channels}.png`);
      writeFileSync(join(images, to), encode({ width, height, data: data.filter((_, i) => i % image.channels < channels), channels }));
      return to;
    };
    return { ...albedo, name: `gray_${channels}`, channels, neutral: { file: reduced(albedo.neutral.file) },
      differences: albedo.differences.map(({ file, scale, offset }) =>
        ({ file: reduced(file), scale: scale.slice(0, channels), offset: offset.slice(0, channels) })) };
  });
  writeFileSync(join(images, 'package.json'), JSON.stringify({ ...description, maps }));
  execFileSync(facezip, ['convert', images, '--texture-format', 'bc7', '--output', blocks]);
  const formats = JSON.parse(readFileSync(join(blocks, 'package.json'))).maps.map((map) => map.neutral.format);
  assert.deepEqual(formats, ['bc4', 'bc5']);
  return blocks;
}

const browser = await launch(browserPath);
const page = await openPage(browser, 'about:blank');
for (const name of ['head', 'many', 'bc7', 'astc-5x5', 'gray']) {
  const packagePath = name === 'gray' ? grayPackage() : join(packages, name);
  const description = JSON.parse(readFileSync(join(packagePath, 'package.json')));
  const names = description.expressions;
  const unreal = join(work, `${name}_unreal`);
  execFileSync(facezip, ['export', packagePath, '--target', 'unreal', '--output', unreal]);
  const { nodes } = JSON.parse(readFileSync(join(unreal, 'FaceZip.json')));
  for (const target of Object.keys(shaders)) {
    await run(`${target}, ${name}: HLSL computes what facezip blend does`, async () => {
      const folder = join(work, `${name}_${target}`);
      if (target !== 'unreal') execFileSync(facezip, ['export', packagePath, '--target', target, '--output', folder]);
      const fromBottom = target === 'unity';
      const prepared = description.maps.map((map, i) => ({
        glsl: toGlsl(folder, `run_${map.name}`, shaders[target](folder, nodes[i], map, names.length)),
        textures: Object.fromEntries(nodes[i].textures.map((file) => [file, engineTexture(folder, file, fromBottom)])),
      }));
      const bake = async (from, weights, i) => {
        const { width, height } = description.maps[i];
        const text = await from.evaluate(draw, { ...prepared[i], width, height, weights: names.map((each) => weights[each] ?? 0) });
        if (!fromBottom) return text;
        return Array.from({ length: height }, (_, y) => text.slice(4 * width * (height - 1 - y), 4 * width * (height - y))).join('');
      };
      const inBlocks = description.maps.some((map) => map.neutral.format);
      assert.equal(prepared.some(({ textures }) => Object.values(textures).some((each) => each.format)), inBlocks && target === 'unity');
      for (const weights of [{}, { [names[1]]: 0.7, [names.at(-1)]: 0.4 }]) {
        const largest = await blendDifference({ facezip, packagePath, description, work }, page, bake, weights);
        console.log(`  largest difference ${largest}/255`);
        // What blocks decode to lies between whole codes: pixels are rounded, and images of blocks before.
        const bound = (Object.keys(weights).length ? 1.5 : 0) + (inBlocks ? 1 : 0);
        assert.ok(largest <= bound, `${largest}/255`);
      }
      const still = (from, _, i) => bake(from, {}, i);
      assert.ok(await blendDifference({ facezip, packagePath, description, work }, page, still, { [names[1]]: 0.7 }) > 4, 'the weights matter');
    });
  }
}
await run('unity: an albedo is shaded as the colour space of the project has it', async () => {
  // Stored as sRGB or as linear light; projects are of either, too.
  const light = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const gamma = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
  for (const stored of ['sRGB', 'linear']) {
    const packagePath = join(work, `surface_${stored}`);
    cpSync(join(packages, 'head'), packagePath, { recursive: true });
    const description = JSON.parse(readFileSync(join(packagePath, 'package.json')));
    const map = { ...description.maps.find((each) => each.name === 'albedo'), colour_space: stored };
    writeFileSync(join(packagePath, 'package.json'), JSON.stringify({ ...description, maps: [map] }));
    const folder = join(work, `surface_${stored}_unity`);
    execFileSync(facezip, ['export', packagePath, '--target', 'unity', '--output', folder]);
    const neutral = decode(readFileSync(join(packagePath, map.neutral.file)));
    const names = [...readFileSync(join(folder, 'FaceZip.hlsl'), 'utf8').matchAll(/^Texture2D<float4> (\w+);/gm)].map((match) => match[1]);
    const textures = Object.fromEntries(names.map((name) => [name, readTexture(join(folder, 'textures', `${name}.png`), true)]));
    const { width, height } = map;
    for (const project of ['linear', 'sRGB']) {
      const glsl = toGlsl(folder, `surface_${project}`, `${project === 'sRGB' ? '#define UNITY_COLORSPACE_GAMMA\n' : ''}#include "FaceZip.hlsl"
float4 main(float4 place : SV_Position) : SV_Target {
  return float4(facezip_surface(place.xy / float2(${width}.0, ${height}.0)).albedo, 1.0);
}`);
      const weights = description.expressions.map(() => 0);
      const drawn = Buffer.from(await page.evaluate(draw, { glsl, textures, weights, width, height }), 'latin1');
      const convert = stored === project ? (c) => c : project === 'linear' ? light : gamma;
      let largest = 0;
      for (let y = 0; y < height; ++y) {
        for (let x = 0; x < width; ++x) {
          for (let c = 0; c < 3; ++c) {
            const wanted = 255 * convert(neutral.data[((height - 1 - y) * width + x) * neutral.channels + c] / 255);
            largest = Math.max(largest, Math.abs(wanted - drawn[4 * (y * width + x) + c]));
          }
        }
      }
      console.log(`  ${stored} in a project that is ${project}: largest difference ${largest.toFixed(3)}/255`);
      assert.ok(largest <= 1, `${largest}/255`);
    }
  }
});
await run('no console errors', () => assert.deepEqual(page.errors, []));
await browser.close();
process.exit(results.failed ? 1 : 0);
