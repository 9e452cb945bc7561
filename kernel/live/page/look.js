// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the body looks: flat faces in the colours of a field, with a lamp at the camera. The processor of the graphics
// finds normals and colours, so that a new state costs one copy of positions and one of values. This shader takes a
// third of the time of three.js's own where the main processor has to draw.
import * as THREE from './three/build/three.module.js';

// Viridis at nine places.
const colours = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725]
  .map((hex) => [hex >> 16, hex >> 8 & 255, hex & 255]);

// The colour at a part from 0 to 1 of the range: red, green and blue from 0 to 255.
export function colour_at(part) {
  const at = Math.min(Math.max(part, 0), 1) * (colours.length - 1);
  const below = Math.min(Math.floor(at), colours.length - 2);
  return colours[below].map((from, k) => Math.round(from + (at - below) * (colours[below + 1][k] - from)));
}

function scale_texture() {
  const width = 256, pixels = new Uint8Array(4 * width);
  for (let i = 0; i < width; ++i) pixels.set([...colour_at(i / (width - 1)), 255], 4 * i);
  const texture = new THREE.DataTexture(pixels, width, 1, THREE.RGBAFormat);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

// Stands for a value that is not there.
export const no_value = -3e38;

const vertex = `
  attribute float value;
  varying vec3 place;
  varying float shown;
  #include <clipping_planes_pars_vertex>
  void main() {
    vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
    place = mvPosition.xyz;
    shown = value;
    gl_Position = projectionMatrix * mvPosition;
    #include <clipping_planes_vertex>
  }`;
// Numbers of pieces have colours that are turned by the golden section of the circle.
const fragment = `
  varying vec3 place;
  varying float shown;
  uniform vec2 range;
  uniform vec3 tint;
  uniform bool is_number;
  uniform sampler2D scale;
  #include <clipping_planes_pars_fragment>
  vec3 colour() {
    if (is_number) {
      vec3 hue = fract(0.6 + 0.618034 * floor(shown + 0.5) + vec3(0.0, 2.0, 1.0) / 3.0);
      return 0.55 + 0.2475 * (2.0 * clamp(abs(6.0 * hue - 3.0) - 1.0, 0.0, 1.0) - 1.0);
    }
    if (shown < -1e37) return vec3(0.6);
    float part = range.y > range.x ? (shown - range.x) / (range.y - range.x) : 0.0;
    return texture2D(scale, vec2((clamp(part, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  }
  void main() {
    #include <clipping_planes_fragment>
    vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
    float light = 0.6 + 0.6 * max(dot(normal, normalize(vec3(0.3, 0.5, 1.0))), 0.0);
    gl_FragColor = vec4(light * tint * colour(), 1.0);
  }`;

// A material of the body; `uniforms` are shared: shared_uniforms().
export function body_material(uniforms, tint) {
  return new THREE.ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, side: THREE.FrontSide,
    uniforms: { ...uniforms, tint: { value: new THREE.Color(tint) } }, clipping: true,
    extensions: { derivatives: true }, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
}
export const shared_uniforms = () => ({ range: { value: new THREE.Vector2() }, is_number: { value: false },
  scale: { value: scale_texture() } });

// Whether the main processor draws: smooth edges then cost four times as much.
export function is_drawn_by_software() {
  const gl = document.createElement('canvas').getContext('webgl'), info = gl?.getExtension('WEBGL_debug_renderer_info');
  return Boolean(info) && /swiftshader|llvmpipe|softpipe|software/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
}
