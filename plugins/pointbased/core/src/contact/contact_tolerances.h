// SPDX-License-Identifier: Apache-2.0
// Thresholds of the contact between two skins: unit, meaning, and the effect of a larger or smaller value.
#pragma once

namespace pointbased::detail {

// kLookaheadSteps: steps of travel covered by a list of patches. More: longer lists, built less often.
// kMaxReach: spacings, upper limit of that distance. Larger: longer lists, built less often.
// kMinLookahead: steps of travel covered at least, beyond kMaxReach if necessary. More: longer lists of fast bodies.
inline constexpr double kLookaheadSteps = 12.0, kMaxReach = 1.0, kMinLookahead = 2.0;
// Spacings: deeper overlap counts only for vertices that were inside before. Smaller: overlap of fast bodies is missed.
inline constexpr double kDeepOverlap = 0.1;
// kSharpEdgeSine: sine of the angle between two faces. Flatter edges are smooth and not tested. Larger: fewer edges.
// kSharpEdgeRise: of the offset: an edge that rises farther along its length is tested at any angle. Larger: fewer
// edges.
inline constexpr double kSharpEdgeSine = 0.05, kSharpEdgeRise = 0.05;
// Of the relative travel of a step: extra distance between fast skins. Residual velocity of the solver and contact
// planes frozen at the beginning of the step then cause no tunnelling. Larger: safer, fast skins stay farther apart.
inline constexpr double kSpeedMargin = 0.1;
// kNormalConeTolerance: sine, tolerance of the cone of directions that leave an edge. Larger: more edge contacts.
// kEdgeEndTolerance: of an edge, length at both ends that does not belong to its interior. It absorbs rounding.
inline constexpr double kNormalConeTolerance = 0.05, kEdgeEndTolerance = 1e-6;
// Cosine: contacts of a vertex with normals closer than that count once. Larger: more contacts per vertex.
inline constexpr double kDuplicateNormalCosine = 0.7;
// Sine of the angle between a face and the edge to a neighbour of a vertex: a steeper neighbour reaches the plane of
// the face first. Larger: fewer vertices are skipped.
inline constexpr double kOcclusionSine = 0.65;
// Cosine between facing and contact normal, for a skin with itself: sides must face each other. Larger: more contacts.
inline constexpr double kMaxFacingCosine = -0.2;
// kReuseDistance: spacings, travel for which gathered candidates stay valid. More: longer lists, gathered less often.
// kQuasiStaticTravel: of that distance: candidates are reused if a step moves by less. Larger: reuse at higher speeds.
inline constexpr double kReuseDistance = 0.03, kQuasiStaticTravel = 0.3;
// Of the margin: approach of open contacts while active ones are reused. Larger: longer reuse, longer search distance.
inline constexpr double kReuseMarginFraction = 0.5;
// Of the offset: a contact that slides farther in a step may be above another face at its end. Smaller: more searches.
inline constexpr double kLargeSlide = 0.1;
// Of the offset: a path that crosses the plane of a face within this distance of it crosses the face. Larger: more.
inline constexpr double kCrossingTolerance = 0.5;
inline constexpr double kMinDirectionLength = 1e-6;  // spacings: shorter connections have no direction

}  // namespace pointbased::detail
