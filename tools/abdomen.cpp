// SPDX-License-Identifier: Apache-2.0
#include "abdomen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "shapes.h"

namespace c3de::tools {

namespace {

enum Label : std::uint16_t {
  none,
  liverLabel,
  tumour,
  gallbladder,
  spleen,
  stomach,
  pancreas,
  kidneyRight,
  kidneyLeft,
  aorta,
  venaCava,
  lungRight,
  lungLeft,
  heart,
  bowel,
  backRight,
  backLeft,
  t10,
  t11,
  t12,
  l1,
  l2,
  l3,
  ribsRight,
  ribsLeft
};

constexpr double kEndless = 1e6;
const Vec3 kLiver{-18.0, -8.0, 20.0};  // the middle of the liver of shapes.h

/// Distance to a tube along points, whose radius tapers.
double tube(const Vec3 &p, std::span<const Vec3> path, double first, double last) {
  double nearest = 1e9;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vec3 along = path[i + 1] - path[i], from = p - path[i];
    const double part = std::clamp(dot(from, along) / dot(along, along), 0.0, 1.0);
    const double share = (static_cast<double>(i) + part) / static_cast<double>(path.size() - 1);
    nearest = std::min(nearest, norm(from - part * along) - (first + share * (last - first)));
  }
  return nearest;
}

double cylinder(const Vec3 &p, double x, double y, double radiusX, double radiusY) {
  return ellipsoid(p, {x, y, p[2]}, {radiusX, radiusY, kEndless});
}

/// The outline of the trunk, wider towards the head.
double trunk(const Vec3 &p) {
  const double scale = 1.0 + 0.03 * p[2] / 112.0;
  return cylinder(p, 0.0, 2.0, 152.0 * scale, 101.0 * scale);
}

double fatWidth(const Vec3 &p) { return 13.0 + 6.0 * std::clamp(-p[1] / 100.0, 0.0, 1.0); }

/// Negative below the domes of the diaphragm, which descends towards the wall.
double diaphragm(const Vec3 &p) {
  const double wide = std::pow(p[0] / 128.0, 2.0) + std::pow((p[1] - 2.0) / 78.0, 2.0);
  const double middle = 14.0 * std::exp(-std::pow(p[0] / 34.0, 2.0));
  const double height = (p[0] < 0.0 ? 90.0 : 82.0) - middle - 62.0 * wide * wide;
  return 0.75 * (p[2] - height);
}

double kidney(const Vec3 &p, double side, double z) {
  const Vec3 middle{side * 62.0, 44.0, z};
  const Vec3 q = turned(p, middle, 1, side * 10.0);
  return carve(ellipsoid(q, middle, {27.0, 24.0, 52.0}),
               ellipsoid(q, middle - Vec3{side * 27.0, 6.0, 0.0}, {12, 14, 17}), 8.0);
}

double spleenAt(const Vec3 &p) {
  const Vec3 middle{94.0, 34.0, 36.0};
  return carve(ellipsoid(turned(p, middle, 2, 25.0), middle, {24, 38, 46}), ellipsoid(p, {62, 16, 30}, {22, 24, 40}),
               10.0);
}

double stomachAt(const Vec3 &p) {
  double d = ellipsoid(p, {66, 14, 36}, {31, 28, 40});
  d = blend(d, ellipsoid(p, {54, -14, 2}, {28, 26, 28}), 18.0);
  return blend(d, ellipsoid(p, {18, -36, -18}, {32, 17, 16}), 14.0);
}

double bowelAt(const Vec3 &p) {
  static constexpr std::array<Vec3, 12> kLoops{{{-70, -40, -84},
                                                {-40, -56, -66},
                                                {-10, -48, -58},
                                                {20, -58, -64},
                                                {52, -52, -56},
                                                {86, -26, -60},
                                                {84, -30, -92},
                                                {52, -54, -90},
                                                {22, -40, -94},
                                                {-8, -58, -92},
                                                {-34, -44, -100},
                                                {-60, -50, -118}}};
  return tube(p, kLoops, 14.0, 12.0);
}

/// Portal and hepatic veins, in the frame of the liver.
double veins(const Vec3 &q) {
  static constexpr std::array<Vec3, 4> kPortalRight{{{14, 20, -34}, {-8, 6, -14}, {-40, 2, -6}, {-72, 10, -18}}};
  static constexpr std::array<Vec3, 2> kPortalFront{{{-38, 2, -6}, {-66, -26, 16}}};
  static constexpr std::array<Vec3, 2> kPortalLow{{{-38, 2, -6}, {-52, -4, -48}}};
  static constexpr std::array<Vec3, 3> kPortalLeft{{{-8, 6, -14}, {28, -14, 4}, {66, -14, 18}}};
  static constexpr std::array<Vec3, 3> kHepaticRight{{{-2, 30, 42}, {-34, 18, 26}, {-78, 4, 6}}};
  static constexpr std::array<Vec3, 3> kHepaticMiddle{{{-2, 30, 42}, {-22, -4, 24}, {-34, -30, -6}}};
  static constexpr std::array<Vec3, 3> kHepaticLeft{{{-2, 30, 42}, {14, -2, 30}, {44, -22, 18}}};
  return std::min({tube(q, kPortalRight, 7.0, 3.0), tube(q, kPortalFront, 4.5, 2.5), tube(q, kPortalLow, 4.5, 2.5),
                   tube(q, kPortalLeft, 5.5, 2.5), tube(q, kHepaticRight, 6.5, 2.5), tube(q, kHepaticMiddle, 6.0, 2.5),
                   tube(q, kHepaticLeft, 5.5, 2.5)});
}

/// One vertebra of 34 mm: body, arch and processes; between two of them a disc of 8 mm.
Tissue spineAt(const Vec3 &p) {
  constexpr double kPeriod = 34.0;
  constexpr std::array<std::uint16_t, 8> kNames{l3, l3, l2, l1, t12, t11, t10, t10};
  const double along = (p[2] + 4.5 * kPeriod) / kPeriod;
  const double number = std::floor(along);
  const double z = (along - number - 0.5) * kPeriod;
  const Vec3 q{p[0], p[1], z};
  const double canal = cylinder(q, 0, 68, 8.5, 8.0);
  if (canal < 0.0) return {30.0, none};
  const double waist = 1.0 - 0.1 * std::exp(-z * z / 60.0);
  const double body = std::max(cylinder(q, 0, 44, 22.0 * waist, 17.0 * waist), std::abs(z) - 13.0);
  const double arch = std::max(cylinder(q, 0, 68, 15.0, 13.0), std::abs(z) - 10.0);
  const double behind = ellipsoid(q, {0, 84, -5}, {4.5, 12, 9});
  const double across = ellipsoid(q, {0, 66, 2}, {36, 5, 6});
  const double bone = std::min({body, arch, behind, across});
  if (bone < 0.0) {
    const auto name = kNames[static_cast<std::size_t>(std::clamp(number + 0.0, 0.0, 7.0))];
    return {bone > -2.5 ? 560.0 : 280.0, name};
  }
  if (cylinder(q, 0, 44, 20.0, 15.5) < 0.0) return {85.0, none};
  return {};
}

/// Ribs descend from the spine to the front, within the muscles of the wall.
double ribsAt(const Vec3 &p) {
  const double angle = std::abs(std::atan2(p[0] / 152.0, (p[1] - 2.0) / 101.0)) / 3.141592653589793;  // 0: at the back
  const double inWall = trunk(p) + fatWidth(p) + 6.0;
  double nearest = 1e9;
  for (int rib = 0; rib < 6; ++rib) {
    const double reaches = rib < 4 ? 0.74 : 0.62 - 0.12 * (rib - 4);
    if (angle < 0.07 || angle > reaches) continue;
    const double height = 136.0 - 30.0 * rib - 66.0 * angle;
    const double r = std::hypot(inWall / 4.2, (p[2] - height) / 6.5);
    nearest = std::min(nearest, 4.2 * (r - 1.0));
  }
  return nearest;
}

/// Liver, gall bladder, stomach and pancreas; where two overlap, the earlier has priority.
Tissue organsInFront(const Vec3 &p, double beside) {
  const Vec3 q = p - kLiver;
  if (const double gall = ellipsoid(turned(p, {-14, -40, -36}, 0, 15.0), {-14, -40, -36}, {13, 14, 27}); gall < 0.0)
    return {gall > -2.0 ? 50.0 : 8.0, gallbladder};
  else if (gall < 2.0)
    return {-95.0, none};
  // Not behind the great vessels.
  const double behind = std::min({p[1] - 22.0, p[0] + 34.0, 60.0 - p[0]});
  const double inLiver = std::max({liver(q), 2.5 - beside, behind});
  if (inLiver < 0.0) {
    if (ellipsoid(q, {-58, -18, -14}, {13, 12, 13}) < 0.0) return {62.0, tumour};
    return {veins(q) < 0.0 ? 168.0 : 108.0, liverLabel};
  }
  if (inLiver < 2.5) return {-95.0, none};
  if (const double d = std::max(stomachAt(p), 2.5 - beside); d < 0.0) return {d > -4.0 ? 60.0 : 18.0, stomach};
  if (std::max(blend(ellipsoid(p, {22, 0, -16}, {48, 9, 11}), ellipsoid(p, {-22, -2, -28}, {17, 13, 18}), 12.0),
               2.5 - beside) < 0.0)
    return {92.0, pancreas};
  return {};
}

/// Below the diaphragm and within the wall.
Tissue cavityAt(const Vec3 &p) {
  for (const double side : {-1.0, 1.0}) {
    const double d = kidney(p, side, side < 0.0 ? -56.0 : -44.0);
    if (d < 0.0) return {d > -8.0 ? 160.0 : 120.0, side < 0.0 ? kidneyRight : kidneyLeft};
  }
  const double inAorta = cylinder(p, 9, 19, 9.5, 9.5), inCava = cylinder(p, -16, 20, 11.0, 9.5);
  if (inAorta < 0.0) return {158.0, aorta};
  if (inCava < 0.0) return {138.0, venaCava};
  if (spleenAt(p) < 0.0) return {124.0, spleen};
  const double beside = std::min({inAorta, inCava, spleenAt(p), kidney(p, -1.0, -56.0), kidney(p, 1.0, -44.0)});
  if (const Tissue organ = organsInFront(p, beside); organ.hounsfield > -1000.0) return organ;
  if (const double d = bowelAt(p); d < 0.0) return {d > -3.5 ? 65.0 : 15.0, bowel};
  // Psoas and the crura of the diaphragm beside the spine.
  for (const double side : {-1.0, 1.0})
    if (p[2] < 20.0 && cylinder(p, side * 31.0, 46, 13.0, 15.0) < 0.0) return {56.0, none};
  return {-96.0, none};
}

Tissue aboveDiaphragm(const Vec3 &p) {
  if (cylinder(p, 9, 19, 9.5, 9.5) < 0.0) return {158.0, aorta};
  const double inHeart = ellipsoid(p, {22, -24, 112}, {54, 44, 32});
  if (inHeart < 0.0) return {140.0, heart};
  if (cylinder(p, -16, 20, 11.0, 9.5) < 0.0) return {138.0, venaCava};
  const bool isMediastinum = std::abs(p[0] - 2.0) < 27.0 && p[1] > -60.0;
  const bool isBelowHeart = std::pow((p[0] - 22.0) / 54.0, 2.0) + std::pow((p[1] + 24.0) / 44.0, 2.0) < 1.0;
  if (isMediastinum || isBelowHeart || inHeart < 4.0) return {-96.0, none};
  return {-820.0, p[0] < 0.0 ? lungRight : lungLeft};
}

}  // namespace

Tissue tissueAt(const Vec3 &p) {
  const double skin = trunk(p);
  if (skin > 0.0) return {};
  if (const Tissue spine = spineAt(p); spine.hounsfield > -1000.0) return spine;
  for (const double side : {-1.0, 1.0})
    if (cylinder(p, side * 27.0, 76, 22.0, 13.0) < 0.0 && skin < -5.0) return {54.0, side < 0.0 ? backRight : backLeft};
  if (skin > -2.0) return {25.0, none};
  const double wall = skin + fatWidth(p);
  if (wall > 0.0) return {-104.0, none};
  if (ribsAt(p) < 0.0) return {ribsAt(p) > -1.6 ? 480.0 : 260.0, p[0] < 0.0 ? ribsRight : ribsLeft};
  if (wall > -12.0) return {56.0, none};
  const double dome = diaphragm(p);
  if (dome > 3.5 && wall < -13.0) return aboveDiaphragm(p);
  if (dome > 0.0) return {58.0, none};
  return cavityAt(p);
}

const std::vector<NamedLabel> &abdomenLabels() {
  static const std::vector<NamedLabel> kLabels{{"liver", {0.75, 0.35, 0.28}},
                                               {"liver_tumor", {0.95, 0.85, 0.30}},
                                               {"gallbladder", {0.35, 0.65, 0.30}},
                                               {"spleen", {0.60, 0.30, 0.55}},
                                               {"stomach", {0.85, 0.60, 0.50}},
                                               {"pancreas", {0.90, 0.75, 0.40}},
                                               {"kidney_right", {0.70, 0.25, 0.20}},
                                               {"kidney_left", {0.65, 0.20, 0.25}},
                                               {"aorta", {0.90, 0.15, 0.15}},
                                               {"inferior_vena_cava", {0.20, 0.35, 0.80}},
                                               {"lung_right", {0.55, 0.75, 0.85}},
                                               {"lung_left", {0.50, 0.70, 0.85}},
                                               {"heart", {0.80, 0.25, 0.30}},
                                               {"small_bowel", {0.90, 0.65, 0.55}},
                                               {"autochthon_right", {0.60, 0.35, 0.30}},
                                               {"autochthon_left", {0.60, 0.33, 0.32}},
                                               {"vertebrae_T10", {0.95, 0.90, 0.75}},
                                               {"vertebrae_T11", {0.93, 0.88, 0.70}},
                                               {"vertebrae_T12", {0.95, 0.90, 0.72}},
                                               {"vertebrae_L1", {0.92, 0.87, 0.68}},
                                               {"vertebrae_L2", {0.95, 0.90, 0.70}},
                                               {"vertebrae_L3", {0.92, 0.87, 0.66}},
                                               {"ribs_right", {0.90, 0.88, 0.80}},
                                               {"ribs_left", {0.88, 0.86, 0.78}}};
  return kLabels;
}

}  // namespace c3de::tools
