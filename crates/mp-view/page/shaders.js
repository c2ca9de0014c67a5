// The programs of the picture: surfaces (and their edges), wide lines, points, and images.

const HEAD = `#version 300 es
precision highp float;
precision highp int;
`;

const ROTATE = `
vec3 rotate(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

/** Copies of a surface; each has a pose, a colour and a stretch along its own axes. `cut` is 0: whole, 1: cut by the plane, 2: cut and closed. */
export const SURFACE_VERTEX = `${HEAD}
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 origin;
layout(location = 2) in vec4 turn;
layout(location = 3) in vec4 color;
layout(location = 4) in float cut;
layout(location = 5) in vec3 stretch;
uniform mat4 view, projection;
uniform vec4 plane;
out vec3 eye;
out vec4 tint;
out float beyond;
flat out float cutKind;
${ROTATE}
void main() {
  vec3 world = rotate(turn, position * stretch) + origin;
  vec4 seen = view * vec4(world, 1.0);
  eye = seen.xyz;
  tint = color;
  cutKind = cut;
  beyond = cut > 0.0 ? dot(plane.xyz, world) - plane.w : -1.0;
  gl_Position = projection * seen;
}`;

/** Lambert shading by a light at the viewer and a sun. Where a closed body is cut, its inside shows as a flat colour. */
export const SURFACE_FRAGMENT = `${HEAD}
in vec3 eye;
in vec4 tint;
in float beyond;
flat in float cutKind;
uniform vec3 sun, cutColor;
uniform vec4 line;
uniform float shaded, cutting, flatView, strength;
out vec4 result;
void main() {
  vec3 slope = cross(dFdx(eye), dFdy(eye));
  if (beyond > 0.0) discard;
  if (shaded == 0.0) {
    result = (line.a > 0.0 ? vec4(line.rgb, line.a * tint.a) : tint) * vec4(1, 1, 1, strength);
    return;
  }
  if (cutKind > 1.5 && cutting > 0.0 && !gl_FrontFacing) {
    result = vec4(cutColor, tint.a);
    return;
  }
  vec3 normal = slope / max(length(slope), 1e-30);
  float head = max(dot(normal, flatView > 0.0 ? vec3(0, 0, 1) : normalize(-eye)), 0.0);
  float light = 0.48 + 0.34 * head + 0.26 * max(dot(normal, sun), 0.0);
  result = vec4(min(tint.rgb * light, 1.0), tint.a);
}`;

/** A segment of a line, as a strip `width` pixels wide. */
export const LINE_VERTEX = `${HEAD}
layout(location = 0) in vec2 corner;
layout(location = 1) in vec3 from;
layout(location = 2) in vec3 to;
layout(location = 3) in vec4 color;
uniform mat4 both;
uniform vec3 origin;
uniform vec4 turn, plane, paint;
uniform vec2 size;
uniform float width, cut;
out vec4 tint;
out float beyond;
${ROTATE}
void main() {
  vec3 a = rotate(turn, from) + origin, b = rotate(turn, to) + origin;
  vec4 p = both * vec4(a, 1.0), q = both * vec4(b, 1.0);
  float dp = p.z + p.w, dq = q.z + q.w;
  if (dp < 0.0 && dq < 0.0) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (dp < 0.0) p = mix(p, q, dp / (dp - dq));
  if (dq < 0.0) q = mix(q, p, dq / (dq - dp));
  vec2 along = (q.xy / q.w - p.xy / p.w) * size;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  vec4 c = corner.x < 0.5 ? p : q;
  vec2 shift = vec2(-along.y, along.x) * corner.y + along * (corner.x - 0.5) * 0.8;
  c.xy += shift * width / size * c.w;
  c.z -= 0.0002 * c.w;
  vec3 world = corner.x < 0.5 ? a : b;
  beyond = cut > 0.0 ? dot(plane.xyz, world) - plane.w : -1.0;
  tint = paint.a > 0.0 ? paint : color;
  gl_Position = c;
}`;

/** Lines of one pixel, which need no corners. */
export const THIN_VERTEX = `${HEAD}
layout(location = 0) in vec3 at;
layout(location = 1) in vec4 color;
uniform mat4 both;
uniform vec3 origin;
uniform vec4 turn, plane, paint;
uniform float cut;
out vec4 tint;
out float beyond;
${ROTATE}
void main() {
  vec3 world = rotate(turn, at) + origin;
  gl_Position = both * vec4(world, 1.0);
  gl_Position.z -= 0.0002 * gl_Position.w;
  beyond = cut > 0.0 ? dot(plane.xyz, world) - plane.w : -1.0;
  tint = paint.a > 0.0 ? paint : color;
}`;

export const LINE_FRAGMENT = `${HEAD}
in vec4 tint;
in float beyond;
uniform float strength;
out vec4 result;
void main() {
  if (beyond > 0.0) discard;
  result = tint * vec4(1, 1, 1, strength);
}`;

/** Round points. The fourth number of the colour is the size as a part of 16 pixels. */
export const POINT_VERTEX = `${HEAD}
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
uniform mat4 both;
uniform vec4 paint;
uniform float ratio;
out vec3 tint;
out float ring;
void main() {
  gl_Position = both * vec4(position, 1.0);
  gl_Position.z -= 0.0004 * gl_Position.w;
  gl_PointSize = color.a * 16.0 * ratio;
  tint = paint.a > 0.0 ? paint.rgb : color.rgb;
  ring = color.a > 0.99 ? 1.0 : 0.0;
}`;

export const POINT_FRAGMENT = `${HEAD}
in vec3 tint;
in float ring;
uniform float strength;
out vec4 result;
void main() {
  float far = length(gl_PointCoord - 0.5);
  if (far > 0.5 || (ring > 0.0 && far < 0.34)) discard;
  result = vec4(tint, strength);
}`;

/** A rectangle with an image. */
export const IMAGE_VERTEX = `${HEAD}
uniform mat4 both;
uniform vec3 corner, right, up;
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = both * vec4(corner + at.x * right + at.y * up, 1.0);
  // A floor may be at the same place.
  gl_Position.z -= 0.0002 * gl_Position.w;
}`;

export const IMAGE_FRAGMENT = `${HEAD}
uniform sampler2D cells;
in vec2 at;
out vec4 result;
void main() {
  result = texture(cells, at);
  if (result.a == 0.0) discard;
}`;
