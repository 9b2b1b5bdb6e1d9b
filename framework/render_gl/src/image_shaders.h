// SPDX-License-Identifier: Apache-2.0
// Shader texts for images. Positions are in the index spaces of the grids; the matrices are computed in double
// precision. Variants are selected by COLOURED, LABELLED, DISPLACED, VACATED, STILL, MISSING, SHIFT, FIELD, COMPARED,
// MAXIMUM, SHADED, LAYERED, because a software renderer executes both sides of a branch.
#pragma once

namespace c3de::render::shaders {

enum ImageUnit : unsigned {
  kImageUnit = 0,
  kLabelUnit = 1,
  kLabelColourUnit = 2,
  kDisplacementUnit = 3,
  kOverlayColourUnit = 4,
  kTransferUnit = 5,
  kDepthUnit = 6,
  kLayerUnit = 7,  // and the next one
  kBodiesUnit = 9,
  kColourUnit = 10,
  kMissingUnit = 11,
  kFieldUnit = 12,
  kSecondUnit = 13,
  kImageUnits = 14
};
enum SliceUniform : int {
  kClipFromLocal = 0,
  kImageFromLocal = 1,
  kLabelFromLocal = 2,
  kNodeFromLocal = 3,
  kImageFromShift = 4,
  kLabelFromShift = 5,
  kGrey = 6,
  kLabelOpacity = 7,
  kOverlay = 8,
  kSecondFromLocal = 9,
  kSecondGrey = 10,
  kSecondWeights = 11,
  kSquaresAlong = 12,
  kSquaresAcross = 13,
};
enum SharedUniform : int { kMinGap = 16 };
enum RayUniform : int {
  kImageFromView = 0,
  kNodeFromView = 1,
  kTextureFromShift = 2,
  kLens = 3,
  kTransfer = 4,
  kStep = 5,
  kPixel = 6,
  kNearest = 7,
  kRayCuts = 8,  // 3 of them
};

inline constexpr const char *kGridFunction = R"(
bool isWithin(vec3 place, vec3 low, vec3 high) {
  return all(greaterThanEqual(place, low)) && all(lessThanEqual(place, high));
}
)";

/// Interface between the stages of slices: positions in the index spaces of the grids. FLOW is in or out.
inline constexpr const char *kSlicePlaces = R"(
FLOW vec3 vImage;
#ifdef LABELLED
FLOW vec3 vLabel;
#endif
#ifdef DISPLACED
FLOW vec3 vNode;
#endif
#ifdef COMPARED
FLOW vec3 vSecond;
FLOW vec2 vSquares;
#endif
)";

/// The reference position of the material at a point: u is stored at integer nodes, 0 outside. The fourth number is the
/// gap, which is large outside. A location is vacated where a gap leads to a body of the reference (p: in the texture
/// of the image). STILL: fixed regions have u = 0, unless a body has moved over them, and leave a gap where material
/// has moved away from them; next to rigid tissue there is one only where the fourth number indicates it.
inline constexpr const char *kDisplacementFunction = R"(
layout(binding = 3) uniform sampler3D uDisplacement;
vec4 shiftAt(vec3 node) {
  vec3 count = vec3(textureSize(uDisplacement, 0));
  vec4 u = texture(uDisplacement, (node + 0.5) / count);
  return isWithin(node, vec3(0.0), count - 1.0) ? u : vec4(0.0, 0.0, 0.0, 1e30);
}
#ifdef VACATED
layout(binding = 9) uniform sampler3D uBodies;
layout(location = 16) uniform float uLeastGap;
#ifdef STILL
/// 0: it does not stay; a quarter: it does; three eighths: as rigid tissue.
float stillAt(vec3 p) {
  vec3 count = vec3(textureSize(uBodies, 0));
  float shown = texelFetch(uBodies, ivec3(clamp(p * count, vec3(0.0), count - 1.0)), 0).r;
  return isWithin(p, vec3(0.0), vec3(1.0)) && shown > 0.1 && shown < 0.45 ? shown : 0.0;
}
#endif
/// @param now, p  the place now and that of its material; shift: (u, gap); what stays is put back
bool isVacated(vec3 now, inout vec3 p, inout vec4 shift) {
  if (isWithin(p, vec3(0.0), vec3(1.0)) && texture(uBodies, p).r > 0.5) return shift.w > uLeastGap;
#ifdef STILL
  if (shift.xyz == vec3(0.0)) return false;
  if (stillAt(now) == 0.0) {
    float was = stillAt(p);
    if (was == 0.0) return false;
    if (was > 0.3 ? shift.w > uLeastGap : length(shift.xyz) > 0.25 * uLeastGap) return true;
  }
  p = now;
  shift.xyz = vec3(0.0);
#endif
  return false;
}
#endif
)";

inline constexpr const char *kSliceVertex = R"(
layout(location = 0) in vec3 aPosition;
layout(location = 0) uniform mat4 uClipFromLocal;
layout(location = 1) uniform mat4 uImageFromLocal;
layout(location = 2) uniform mat4 uLabelFromLocal;
layout(location = 3) uniform mat4 uNodeFromLocal;
layout(location = 9) uniform mat4 uSecondFromLocal;
layout(location = 12) uniform vec4 uSquaresAlong;
layout(location = 13) uniform vec4 uSquaresAcross;
void main() {
  vec4 p = vec4(aPosition, 1.0);
  vImage = (uImageFromLocal * p).xyz;
#ifdef LABELLED
  vLabel = (uLabelFromLocal * p).xyz;
#endif
#ifdef DISPLACED
  vNode = (uNodeFromLocal * p).xyz;
#endif
#ifdef COMPARED
  vSecond = (uSecondFromLocal * p).xyz;
  vSquares = vec2(dot(uSquaresAlong, p), dot(uSquaresAcross, p));
#endif
  gl_Position = uClipFromLocal * p;
}
)";

inline constexpr const char *kSliceFragment = R"(
layout(location = 4) uniform mat3 uImageFromShift;
layout(location = 5) uniform mat3 uLabelFromShift;
layout(location = 6) uniform vec2 uGrey;
layout(location = 7) uniform float uLabelOpacity;
layout(location = 8) uniform vec3 uOverlay;  // low, 1 / range, opacity
layout(binding = 0) uniform sampler3D uImage;
layout(binding = 1) uniform usampler3D uLabels;
layout(binding = 2) uniform sampler2D uLabelColours;
layout(binding = 4) uniform sampler2D uOverlayColours;
layout(binding = 10) uniform sampler3D uColours;
#ifdef MISSING
layout(binding = 11) uniform sampler3D uMissing;
#endif
#ifdef FIELD
layout(binding = 12) uniform sampler3D uField;
#endif
#ifdef COMPARED
layout(binding = 13) uniform sampler3D uSecond;
layout(location = 10) uniform vec3 uSecondGrey;     // gain, bias, 1 for colours
layout(location = 11) uniform vec2 uSecondWeights;  // in even squares, in odd ones
/// Red, green, blue, and the weight of the second image. Outside of it the first one is shown.
vec4 secondAt() {
  vec3 count = vec3(textureSize(uSecond, 0));
  vec3 texel = texture(uSecond, (vSecond + 0.5) / count).rgb;
  vec3 grey = mix(texel.rrr, texel, uSecondGrey.z) * uSecondGrey.x + uSecondGrey.y;
  float parity = mod(floor(vSquares.x) + floor(vSquares.y), 2.0);
  bool isInside = isWithin(vSecond, vec3(-0.5), count - 0.5);
  return vec4(clamp(grey, 0.0, 1.0), isInside ? mix(uSecondWeights.x, uSecondWeights.y, parity) : 0.0);
}
#endif
out vec4 oColour;
void main() {
  precise vec3 index = vImage;
  vec3 count = vec3(textureSize(uImage, 0));
#ifdef DISPLACED
  vec4 shift = shiftAt(vNode);
  index -= uImageFromShift * shift.xyz;
#ifdef VACATED
  vec3 place = (index + 0.5) / count;
  bool vacated = isVacated((vImage + 0.5) / count, place, shift);
#ifdef STILL
  if (shift.xyz == vec3(0.0)) index = vImage;
#endif
#endif
  vec3 u = shift.xyz;
#endif
#ifdef COLOURED
  vec3 texel = texture(uColours, (index + 0.5) / count).rgb;
#else
  vec3 texel = texture(uImage, (index + 0.5) / count).rrr;
#endif
  bool isInside = isWithin(index, vec3(-0.5), count - 0.5);
  vec3 colour = isInside ? clamp(texel * uGrey.x + uGrey.y, 0.0, 1.0) : vec3(0.0);
#ifdef COMPARED
  vec4 second = secondAt();
  colour = mix(colour, second.rgb, second.a);
#endif
#ifdef LABELLED
  vec3 label = vLabel;
#ifdef DISPLACED
  label -= uLabelFromShift * u;
#endif
  ivec3 at = ivec3(floor(label + 0.5)), last = textureSize(uLabels, 0) - 1;
  uint value = texelFetch(uLabels, clamp(at, ivec3(0), last), 0).r;
  vec4 tint = texelFetch(uLabelColours, ivec2(value & 255u, value >> 8u), 0);
  bool isLabelled = isWithin(vec3(at), vec3(0.0), vec3(last));
  colour = mix(colour, tint.rgb, isLabelled ? tint.a * uLabelOpacity : 0.0);
#endif
#ifdef SHIFT
  float size = length(u);
  vec3 map = texture(uOverlayColours, vec2((size - uOverlay.x) * uOverlay.y, 0.5)).rgb;
  // Fades in over the first twentieth of the range, so that the cells of the grid do not show at the rim.
  colour = mix(colour, map, uOverlay.z * clamp(20.0 * (size - uOverlay.x) * uOverlay.y, 0.0, 1.0));
#endif
#ifdef FIELD
  // The sum of those points of the cell that have a value, and their share.
  vec3 nodes = vec3(textureSize(uField, 0));
  vec2 sum = texture(uField, (vNode + 0.5) / nodes).rg;
  bool isTissue = sum.g > 1e-3 && isWithin(vNode, vec3(0.0), nodes - 1.0);
#ifdef VACATED
  isTissue = isTissue && !vacated && isWithin(place, vec3(0.0), vec3(1.0)) && texture(uBodies, place).r > 0.5;
#endif
  vec3 ofField = texture(uOverlayColours, vec2((sum.r / max(sum.g, 1e-3) - uOverlay.x) * uOverlay.y, 0.5)).rgb;
  colour = mix(colour, ofField, isTissue ? uOverlay.z : 0.0);
#endif
#ifdef VACATED
  // Hatched: nothing is known of what is there now.
  if (vacated) {
    colour = mod(gl_FragCoord.x + gl_FragCoord.y, 9.0) < 1.0 ? vec3(0.2, 0.3, 0.32) : vec3(0.02);
#ifdef COMPARED
    colour = mix(colour, second.rgb, second.a);  // the second image is known there
#endif
  }
#endif
#ifdef MISSING
  // Hatched the other way: meant to be a body, and in none.
  vec3 there = (index + 0.5) / count;
  if (isWithin(there, vec3(0.0), vec3(1.0)) && texture(uMissing, there).r > 0.5)
    colour = mix(colour, vec3(1.0, 0.45, 0.95), mod(gl_FragCoord.x - gl_FragCoord.y, 6.0) < 2.5 ? 0.95 : 0.3);
#endif
  oColour = vec4(colour, 1.0);
}
)";

// Slightly towards the eye, so that the border of a slice is in front of it.
inline constexpr const char *kOutlineVertex = R"(
layout(location = 0) in vec3 aPosition;
layout(location = 0) uniform mat4 uClipFromLocal;
void main() {
  gl_Position = uClipFromLocal * vec4(aPosition, 1.0);
  gl_Position.z -= 1e-4 * gl_Position.w;
}
)";
inline constexpr const char *kOutlineFragment = R"(
layout(location = 1) uniform vec4 uColour;
out vec4 oColour;
void main() { oColour = uColour; }
)";

inline constexpr const char *kFullVertex = R"(
void main() {
  // One triangle that covers the viewport.
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

// Samples are at fixed distances from the eye, independent of where a ray enters. The inner loop searches for the next
// non-transparent sample: costly work (the gradient) is done for those only, and by neighbours of a vector register
// together. `precise` keeps the positions identical to the bit whether or not a zero displacement is subtracted.
inline constexpr const char *kRayFragment = R"(
layout(location = 0) uniform mat4 uImageFromView;
layout(location = 1) uniform mat4 uNodeFromView;
layout(location = 2) uniform mat3 uTextureFromShift;
layout(location = 3) uniform vec4 uLens;      // view direction of ndc (1, 1); depth of ndc z
layout(location = 4) uniform vec2 uTransfer;  // texel to table (MAXIMUM: to grey)
layout(location = 5) uniform float uStep;     // mm
layout(location = 6) uniform vec2 uPixel;     // ndc per pixel
layout(location = 7) uniform float uNearest;
layout(location = 8) uniform vec4 uCuts[3];   // planes in view space; their negative side is left out
layout(binding = 0) uniform sampler3D uImage;
layout(binding = 5) uniform sampler2D uTable;
layout(binding = 6) uniform sampler2D uDepth;
layout(location = 0) out vec4 oColour;
#ifdef LAYERED
// Beside what is in front of all surfaces that blend: what lies behind the nearest, and behind the next one.
layout(binding = 7) uniform sampler2D uNearestLayer;
layout(binding = 8) uniform sampler2D uNextLayer;
layout(location = 1) out vec4 oBehind;
layout(location = 2) out vec4 oLast;
#endif

vec2 slab(vec3 origin, vec3 direction, vec3 low, vec3 high) {
  vec3 safe = mix(direction, vec3(1e-8), lessThan(abs(direction), vec3(1e-8)));
  vec3 a = (low - origin) / safe, b = (high - origin) / safe;
  vec3 enter = min(a, b), leave = max(a, b);
  return vec2(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

/// From the eye to what a depth buffer holds.
float distanceOf(sampler2D depths, float slant) {
  float depth = texelFetch(depths, ivec2(gl_FragCoord.xy), 0).r;
  return depth >= 1.0 ? 1e30 : slant * uLens.w / (2.0 * depth - 1.0 + uLens.z);
}

void main() {
  precise vec3 direction = vec3((gl_FragCoord.xy * uPixel - 1.0) * uLens.xy, -1.0);
  float slant = length(direction);
  direction /= slant;

  vec3 count = vec3(textureSize(uImage, 0));
  precise vec3 origin = uImageFromView[3].xyz, along = mat3(uImageFromView) * direction;
  vec2 range = slab(origin, along, vec3(-0.5), count - 0.5);
#ifdef DISPLACED
  vec3 nodeOrigin = uNodeFromView[3].xyz, nodeAlong = mat3(uNodeFromView) * direction;
  vec2 grid = slab(nodeOrigin, nodeAlong, vec3(0.0), vec3(textureSize(uDisplacement, 0) - 1));
  if (grid.x < grid.y) range = range.x < range.y ? vec2(min(range.x, grid.x), max(range.y, grid.y)) : grid;
#endif
  range = vec2(max(range.x, uNearest * slant), min(range.y, distanceOf(uDepth, slant)));
  for (int i = 0; i < 3; ++i) {
    float along_ = dot(uCuts[i].xyz, direction), from = uCuts[i].w;
    if (along_ > 0.0) range.x = max(range.x, -from / along_);
    else if (along_ < 0.0) range.y = min(range.y, -from / along_);
    else if (from < 0.0) range.y = range.x;
  }
  oColour = vec4(0.0);
#ifdef LAYERED
  oBehind = oLast = vec4(0.0);
  float nearest = distanceOf(uNearestLayer, slant), next = distanceOf(uNextLayer, slant);
#endif
  if (!(range.x < range.y)) return;

  precise vec3 textureOrigin = (origin + 0.5) / count, textureAlong = along / count;
  // Rays begin at different fractions of a step, without a pattern: else steps show as rings.
  uint noise = uint(gl_FragCoord.x) * 0x9e3779b9u ^ uint(gl_FragCoord.y) * 0x85ebca6bu;
  noise = (noise ^ (noise >> 16u)) * 0x7feb352du;
  noise = (noise ^ (noise >> 15u)) * 0x846ca68bu;
  float jitter = float(noise >> 16u) / 65536.0;
  float number = ceil(range.x / uStep - jitter);
  precise float t = (number + jitter) * uStep;
#ifdef MAXIMUM
  vec3 most = vec3(-1e30);  // in front of the surfaces that blend, behind the nearest, behind the next
  while (t < range.y) {
    precise vec3 p = textureOrigin + t * textureAlong;
#ifdef DISPLACED
    vec4 shift = shiftAt(nodeOrigin + t * nodeAlong);
    vec3 now = p;
    p -= uTextureFromShift * shift.xyz;
#ifdef VACATED
    vec3 place = p;
    bool vacated = isVacated(now, place, shift);
    p = place;
#endif
#endif
    float texel = isWithin(p, vec3(0.0), vec3(1.0)) ? texture(uImage, p).r : -1e30;
#ifdef VACATED
    if (vacated) texel = -1e30;
#endif
#ifdef LAYERED
    most = max(most, mix(vec3(-1e30), vec3(texel), bvec3(t < nearest, t >= nearest && t < next, t >= next)));
#else
    most.x = max(most.x, texel);
#endif
    t = (++number + jitter) * uStep;
  }
  vec3 grey = mix(vec3(0.0), clamp(most * uTransfer.x + uTransfer.y, 0.0, 1.0), greaterThan(most, vec3(-1e29)));
  oColour = vec4(grey.x);
#ifdef LAYERED
  // Laid over each other, with nothing between them, the parts give the maximum of all.
  float two = max(grey.x, grey.y);
  oBehind = vec4((two - grey.x) / max(1.0 - grey.x, 1e-6));
  oLast = vec4((max(two, grey.z) - two) / max(1.0 - two, 1e-6));
#endif
#else
  vec4 sum = vec4(0.0);
#ifdef LAYERED
  vec4 behind = vec4(0.0), last = vec4(0.0);
  float place = 0.0;
#endif
#ifdef SHADED
  vec3 voxel = 1.0 / count;
  mat3 viewFromGradient = transpose(mat3(uImageFromView));
#endif
#ifdef LAYERED
#define HIDDEN (1.0 - (1.0 - sum.a) * (1.0 - behind.a) * (1.0 - last.a))
#else
#define HIDDEN sum.a
#endif
  while (t < range.y && HIDDEN < 0.98) {
    precise vec3 p = vec3(0.0);
    vec4 colour = vec4(0.0);
    // Not do … while: Mesa 22 then loses samples of some rays.
    while (colour.a < 0.001 && t < range.y) {
      p = textureOrigin + t * textureAlong;
#ifdef DISPLACED
      vec4 shift = shiftAt(nodeOrigin + t * nodeAlong);
      vec3 now = p;
      p -= uTextureFromShift * shift.xyz;
#ifdef VACATED
      vec3 place = p;
      bool vacated = isVacated(now, place, shift);
      p = place;
#endif
#endif
      colour = texture(uTable, vec2(texture(uImage, p).r * uTransfer.x + uTransfer.y, 0.5));
      colour.a = isWithin(p, vec3(0.0), vec3(1.0)) ? colour.a : 0.0;
#ifdef VACATED
      if (vacated) colour.a = 0.0;
#endif
#ifdef LAYERED
      place = t;
#endif
      t = (++number + jitter) * uStep;
    }
#ifdef SHADED
    vec3 dx = vec3(voxel.x, 0.0, 0.0), dy = vec3(0.0, voxel.y, 0.0), dz = vec3(0.0, 0.0, voxel.z);
    vec3 gradient = vec3(texture(uImage, p + dx).r - texture(uImage, p - dx).r,
                         texture(uImage, p + dy).r - texture(uImage, p - dy).r,
                         texture(uImage, p + dz).r - texture(uImage, p - dz).r);
    vec3 normal = viewFromGradient * gradient;
    float size = length(normal);
    // Seen from the front whichever side is brighter.
    float facing = size > 1e-12 ? abs(dot(normal, direction)) / size : 0.7;
    vec3 half_ = normalize(vec3(0.3, 0.5, 0.8) - direction);
    float shine = size > 1e-12 ? pow(abs(dot(normal, half_)) / size, 24.0) : 0.0;
    colour.rgb = colour.rgb * (0.28 + 0.72 * facing) + vec3(0.14 * shine);
#endif
    vec4 one = colour.a * vec4(min(colour.rgb, vec3(1.0)), 1.0);
#ifdef LAYERED
    sum += place < nearest ? (1.0 - sum.a) * one : vec4(0.0);
    behind += place >= nearest && place < next ? (1.0 - behind.a) * one : vec4(0.0);
    last += place >= next ? (1.0 - last.a) * one : vec4(0.0);
#else
    sum += (1.0 - sum.a) * one;
#endif
  }
  oColour = sum;
#ifdef LAYERED
  oBehind = behind;
  oLast = last;
#endif
#endif
}
)";

inline constexpr const char *kCompositeFragment = R"(
layout(binding = 0) uniform sampler2D uColour;
layout(location = 0) uniform vec4 uPlace;  // lower left corner of the viewport, 1 / its size
out vec4 oColour;
void main() { oColour = texture(uColour, (gl_FragCoord.xy - uPlace.xy) * uPlace.zw); }
)";

}  // namespace c3de::render::shaders
