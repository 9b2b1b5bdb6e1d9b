// SPDX-License-Identifier: Apache-2.0
// Shader texts. All positions are in view space: the eye is the origin and looks along -z, so that floats suffice
// wherever the scene is in the world. Input colours are sRGB, lighting is in linear light, and output is encoded as
// sRGB, so the result does not depend on the kind of framebuffer; blending therefore operates on encoded values.
#pragma once

namespace c3de::render::shaders {

/// Attribute and uniform locations shared by the texts below.
enum Attribute : unsigned {
  kPosition = 0,
  kNormal = 1,  // meshes
  kColour = 2,
  kRadius = 3,     // spheres
  kEnd = 1,        // lines
  kEndColour = 3,  // lines
  kWidth = 4       // lines
};
enum Uniform : int {
  kProjection = 0,
  kViewFromProxy = 1,
  kNormalMatrix = 2,  // meshes
  kTwoSided = 3,      // meshes
  kBlended = 4,       // meshes, spheres
  kRadiusScale = 2,   // spheres
  kSmoothEdge = 3,    // spheres
  kViewportSize = 2,  // lines, labels
  kNear = 3,          // lines
  kAtlas = 3,         // labels
  kCuts = 5,          // meshes, spheres, lines: 3 of them
  kCover = 8,         // meshes
  kTopColour = 0,     // background
  kBottomColour = 1   // background
};

/// Building blocks: a stage is the head, the functions it uses and its own text.
inline constexpr const char *kHead = "#version 430 core\n";

inline constexpr const char *kColourFunctions = R"(
vec3 toLinear(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c));
}
vec3 toSrgb(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c));
}
)";

// A soft box above the viewer's left shoulder, a weak fill light from the right, ambient light that is brighter and
// cooler from above, a broad wet highlight and a faint rim that separates the silhouette from the background. With
// these weights a surface that faces the viewer has about the brightness of its colour.
inline constexpr const char *kShadeFunctions = R"(
vec3 shade(vec3 n, vec3 v, vec3 albedo) {
  const vec3 key = vec3(-0.424, 0.636, 0.645);
  const vec3 fill = vec3(0.873, -0.087, 0.480);
  float facing = clamp(dot(n, v), 0.0, 1.0);
  float wrapped = max(dot(n, key) + 0.25, 0.0) * (1.0 / 1.25);
  float sky = 0.5 + 0.5 * n.y;
  vec3 light = mix(vec3(0.135, 0.115, 0.11), vec3(0.30, 0.32, 0.35), sky)
             + wrapped * wrapped * vec3(1.05, 1.02, 0.98)
             + max(dot(n, fill), 0.0) * vec3(0.13, 0.14, 0.16);
  float highlight = max(dot(n, normalize(key + v)), 0.0);
  float h2 = highlight * highlight, h4 = h2 * h2, h8 = h4 * h4, h16 = h8 * h8, h64 = h16 * h16 * h16 * h16;
  float rim = 1.0 - facing;
  rim = rim * rim * rim;
  return albedo * light + vec3(0.035 * h16 + 0.16 * h64 * h16) + rim * (0.03 + 0.09 * sky) * (0.4 + albedo);
}
)";

/// The negative side of a plane is not drawn.
inline constexpr const char *kCutFunction = R"(
layout(location = 5) uniform vec4 uCuts[3];
out float gl_ClipDistance[3];
void cut(vec3 place) {
  for (int i = 0; i < 3; ++i) gl_ClipDistance[i] = dot(uCuts[i], vec4(place, 1.0));
}
)";

/// Transparent surfaces, separated by depth where PEELED: only the part behind the nearer and not behind the farther
/// depth is drawn. The depths come from the same vertices, so that they agree up to some units in the last place.
inline constexpr const char *kPeelFunction = R"(
#ifdef PEELED
layout(binding = 0) uniform sampler2D uNearer;
layout(binding = 1) uniform sampler2D uFarther;
float depthIn(sampler2D depths) {
  return texelFetch(depths, min(ivec2(gl_FragCoord.xy), textureSize(depths, 0) - 1), 0).r;
}
void peel(float depth, float alpha) {
  const float kSame = 4e-7;
  if (alpha <= 0.0 || depth <= depthIn(uNearer) + kSame || depth > depthIn(uFarther) + kSame) discard;
}
#else
void peel(float depth, float alpha) {}
#endif
)";

inline constexpr const char *kBackgroundVertex = R"(
out float vHeight;
void main() {
  // One triangle that covers the viewport.
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  vHeight = 0.5 + 0.5 * p.y;
  gl_Position = vec4(p, 0.0, 1.0);
}
)";
inline constexpr const char *kBackgroundFragment = R"(
layout(location = 0) uniform vec3 uTop;
layout(location = 1) uniform vec3 uBottom;
in float vHeight;
out vec4 oColour;
void main() { oColour = vec4(mix(uBottom, uTop, vHeight), 1.0); }
)";

inline constexpr const char *kMeshVertex = R"(
layout(location = 0) in vec3 aPosition;
layout(location = 1) in vec3 aNormal;
layout(location = 2) in vec4 aColour;
layout(location = 0) uniform mat4 uProjection;
layout(location = 1) uniform mat4 uViewFromProxy;
layout(location = 2) uniform mat3 uNormalMatrix;
layout(location = 8) uniform float uCover;
out vec3 vPosition;
out vec3 vNormal;
out vec4 vColour;
void main() {
  vec4 p = uViewFromProxy * vec4(aPosition, 1.0);
  vec3 n = uNormalMatrix * aNormal;
  float nn = dot(n, n);
  vPosition = p.xyz;
  vNormal = nn > 0.0 ? n * inversesqrt(nn) : vec3(0.0, 0.0, 1.0);
  vColour = vec4(toLinear(aColour.rgb), aColour.a);
  cut(p.xyz);
  gl_Position = uProjection * p;
  if (uCover > 0.0) {  // as deep as if it were thicker by that, where it is
    vec4 thicker = uProjection * vec4(p.xyz + uCover * vNormal, 1.0);
    gl_Position.z = thicker.z / thicker.w * gl_Position.w;
  }
}
)";
inline constexpr const char *kMeshFragment = R"(
layout(location = 3) uniform int uTwoSided;
layout(location = 4) uniform int uBlended;
in vec3 vPosition;
in vec3 vNormal;
in vec4 vColour;
out vec4 oColour;
void main() {
  vec3 v = normalize(-vPosition);
  vec3 n = normalize(vNormal);
  if (uTwoSided != 0 && !gl_FrontFacing) n = -n;
  float alpha = 1.0;
  if (uBlended != 0) {
    // A thin film is crossed on a longer way at a slant; this keeps the shape of a transparent organ readable.
    float facing = clamp(dot(n, v), 0.35, 1.0);
    alpha = 1.0 - pow(1.0 - clamp(vColour.a, 0.0, 1.0), 1.0 / facing);
  }
  peel(gl_FragCoord.z, alpha);
  oColour = vec4(toSrgb(shade(n, v, vColour.rgb)), alpha);
}
)";

// A sphere is drawn as a square that just encloses its silhouette; the fragment shader computes the exact point of the
// sphere. Cuts keep or remove it as a whole.
inline constexpr const char *kSphereVertex = R"(
layout(location = 0) in vec3 aCentre;
layout(location = 2) in vec4 aColour;
layout(location = 3) in float aRadius;
layout(location = 0) uniform mat4 uProjection;
layout(location = 1) uniform mat4 uViewFromProxy;
layout(location = 2) uniform float uRadiusScale;
out vec3 vRay;
flat out vec3 vCentre;
flat out float vRadius;
flat out vec4 vColour;
void main() {
  vec3 c = (uViewFromProxy * vec4(aCentre, 1.0)).xyz;
  float r = aRadius * uRadiusScale;
  float d = length(c);
  vRay = c;
  vCentre = c;
  vRadius = r;
  vColour = vec4(toLinear(aColour.rgb), aColour.a);
  cut(c);
  if (!(d > r * 1.0001) || !(r > 0.0)) {  // no size, or the eye is inside: nothing to see
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  // In the plane through the centre that faces the eye, the cone of tangents has this radius.
  float silhouette = r * d / sqrt(d * d - r * r);
  vec3 w = c / d;
  vec3 u = normalize(abs(w.y) < 0.9 ? cross(w, vec3(0.0, 1.0, 0.0)) : cross(w, vec3(1.0, 0.0, 0.0)));
  vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  vRay = c + silhouette * (corner.x * u + corner.y * cross(u, w));
  gl_Position = uProjection * vec4(vRay, 1.0);
}
)";
inline constexpr const char *kSphereFragment = R"(
layout(location = 0) uniform mat4 uProjection;
layout(location = 3) uniform int uSmoothEdge;
layout(location = 4) uniform int uBlended;
in vec3 vRay;
flat in vec3 vCentre;
flat in float vRadius;
flat in vec4 vColour;
out vec4 oColour;
void main() {
  // |t d - c| = r along the ray t d; the offset of the ray from the centre avoids the cancellation of d.c² - c.c.
  vec3 d = normalize(vRay);
  float along = dot(d, vCentre);
  vec3 offset = vCentre - along * d;
  float h = vRadius * vRadius - dot(offset, offset);
  float coverage = 1.0;
  if (uSmoothEdge != 0) coverage = clamp(h / max(fwidth(h), 1e-30) + 0.5, 0.0, 1.0);
  else if (h < 0.0) discard;
  if (coverage <= 0.0) discard;
  vec3 p = (along - sqrt(max(h, 0.0))) * d;
  vec3 n = (p - vCentre) / vRadius;
  float depth = (uProjection[2][2] * p.z + uProjection[3][2]) / -p.z;
  gl_FragDepth = clamp(0.5 + 0.5 * depth, 0.0, 1.0);
  float alpha = uBlended != 0 ? clamp(vColour.a, 0.0, 1.0) : 1.0;
  peel(gl_FragDepth, alpha);
  oColour = vec4(toSrgb(shade(normalize(n), -d, vColour.rgb)), alpha * coverage);
}
)";

// The core profile has no wide lines: each segment becomes a rectangle of the requested width in pixels.
inline constexpr const char *kLineVertex = R"(
layout(location = 0) in vec3 aStart;
layout(location = 1) in vec3 aEnd;
layout(location = 2) in vec4 aStartColour;
layout(location = 3) in vec4 aEndColour;
layout(location = 4) in float aWidth;
layout(location = 0) uniform mat4 uProjection;
layout(location = 1) uniform mat4 uViewFromProxy;
layout(location = 2) uniform vec2 uViewportSize;
layout(location = 3) uniform float uNear;
out vec4 vColour;
void main() {
  vec3 a = (uViewFromProxy * vec4(aStart, 1.0)).xyz;
  vec3 b = (uViewFromProxy * vec4(aEnd, 1.0)).xyz;
  bool atEnd = (gl_VertexID & 1) != 0;
  vColour = atEnd ? aEndColour : aStartColour;
  cut(atEnd ? b : a);
  float limit = -1.002 * uNear;  // a point behind the eye has no pixel: cut the segment in front of the near plane
  if (!(min(a.z, b.z) < limit)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  vec3 a2 = a.z > limit ? mix(a, b, (limit - a.z) / (b.z - a.z)) : a;
  vec3 b2 = b.z > limit ? mix(b, a, (limit - b.z) / (a.z - b.z)) : b;
  // A little towards the eye (the projection stays), so that lines drawn on a surface win over it.
  vec4 ca = uProjection * vec4(a2 * 0.9995, 1.0);
  vec4 cb = uProjection * vec4(b2 * 0.9995, 1.0);
  vec2 along = (cb.xy / cb.w - ca.xy / ca.w) * uViewportSize;
  float length2 = dot(along, along);
  along = length2 > 1e-12 ? along * inversesqrt(length2) : vec2(1.0, 0.0);
  vec2 side = (gl_VertexID & 2) == 0 ? vec2(-along.y, along.x) : vec2(along.y, -along.x);
  vec4 c = atEnd ? cb : ca;
  // Square caps: the joints of a polyline stay closed.
  vec2 offset_px = 0.5 * aWidth * (side + (atEnd ? along : -along));
  gl_Position = c + vec4(2.0 * offset_px / uViewportSize * c.w, 0.0, 0.0);
}
)";
inline constexpr const char *kLineFragment = R"(
in vec4 vColour;
out vec4 oColour;
void main() {
  peel(gl_FragCoord.z, vColour.a);
  oColour = vColour;
}
)";

// Pixels from the lower left corner of the viewport; the atlas holds the glyph in red and its dilated shape in green.
inline constexpr const char *kLabelVertex = R"(
layout(location = 0) in vec2 aPixel;
layout(location = 1) in vec2 aTexel;
layout(location = 2) in vec4 aColour;
layout(location = 2) uniform vec2 uViewportSize;
layout(location = 3) uniform sampler2D uAtlas;
out vec2 vTexture;
out vec4 vColour;
void main() {
  vTexture = aTexel / vec2(textureSize(uAtlas, 0));
  vColour = aColour;
  gl_Position = vec4(2.0 * aPixel / uViewportSize - 1.0, 0.0, 1.0);
}
)";
inline constexpr const char *kLabelFragment = R"(
layout(location = 3) uniform sampler2D uAtlas;
in vec2 vTexture;
in vec4 vColour;
out vec4 oColour;
void main() {
  vec2 cover = vTexture.x < 0.0 ? vec2(1.0) : texture(uAtlas, vTexture).rg;  // below 0: a plain area
  // The outline is dark under light text and light under dark text.
  float lightness = dot(vColour.rgb, vec3(0.30, 0.59, 0.11));
  vec3 outline = lightness > 0.35 ? vec3(0.03) : vec3(0.95);
  float alpha = max(cover.r, 0.85 * cover.g);
  oColour = vec4(mix(outline, vColour.rgb, cover.r / max(alpha, 1e-4)), alpha * vColour.a);
}
)";

}  // namespace c3de::render::shaders
