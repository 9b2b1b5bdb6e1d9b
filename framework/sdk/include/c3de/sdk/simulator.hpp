// SPDX-License-Identifier: Apache-2.0
// Tables of the simulation interfaces from classes whose members carry the slots' names in lowerCamelCase.
#pragma once

#include "c3de/sdk/object.hpp"

namespace c3de::sdk {

// Asked of the class and not of the slot: with UBSan GCC does not count a comparison of function pointers as constant.
template <class D>
inline constexpr bool kHasDisplacement = requires {
  &D::displacement;
};
template <class D>
inline constexpr bool kHasInterrupt = requires {
  &D::interrupt;
  &D::activity;
};
template <class D>
inline constexpr bool kHasPoints = requires {
  &D::points;
};
template <class D>
inline constexpr bool kHasTriangles = requires {
  &D::triangles;
};

template <class D>
constexpr auto displacementSlot() -> decltype(c3de_simulator_v0::displacement) {
  if constexpr (kHasDisplacement<D>)
    return thunk<D, &D::displacement>;
  else
    return nullptr;
}

template <class D>
constexpr auto interruptSlot() -> decltype(c3de_simulator_v0::interrupt) {
  if constexpr (kHasInterrupt<D>)
    return thunk<D, &D::interrupt>;
  else
    return nullptr;
}

template <class D>
constexpr auto activitySlot() -> decltype(c3de_simulator_v0::activity) {
  if constexpr (kHasInterrupt<D>)
    return thunk<D, &D::activity>;
  else
    return nullptr;
}

template <class D>
constexpr auto pointsSlot() -> decltype(c3de_simulator_v0::points) {
  if constexpr (kHasPoints<D>)
    return thunk<D, &D::points>;
  else
    return nullptr;
}

template <class D>
constexpr std::uint32_t simulatorRevision() {
  if (!kHasDisplacement<D>) return 2;
  if (!kHasInterrupt<D>) return 3;
  return kHasPoints<D> ? 5 : 4;
}

/// Static table of iface.simulator for an Object<Derived>; every slot has a member function of Derived (see
/// thunk). addBody() has to serve fixes, loads, parts, refinements and velocities, or refuse them. It is of
/// revision 3 where Derived has displacement(), and addBody() then has to serve or refuse `fill`, else of revision 2;
/// of revision 4 where it has displacement(), interrupt() and activity(), and of 5 with points() beside them:
///
///   static std::array<Interface, 1> interfaces() { return {interfaceOf(kSimulatorTable<WorldSimulator>)}; }
template <class D>
inline constexpr c3de_simulator_v0 kSimulatorTable{
    sizeof(c3de_simulator_v0),  simulatorRevision<D>(),  thunk<D, &D::attach>,
    thunk<D, &D::declarations>, thunk<D, &D::setWorld>,  thunk<D, &D::addBody>,
    thunk<D, &D::addObstacle>,  thunk<D, &D::addProbe>,  thunk<D, &D::setBodyParam>,
    thunk<D, &D::getBodyParam>, thunk<D, &D::remove>,    thunk<D, &D::clear>,
    thunk<D, &D::step>,         thunk<D, &D::reset>,     thunk<D, &D::publish>,
    thunk<D, &D::status>,       thunk<D, &D::stateHash>, thunk<D, &D::report>,
    thunk<D, &D::bodyAt>,       thunk<D, &D::bodyInfo>,  thunk<D, &D::phyxels>,
    thunk<D, &D::surfels>,      displacementSlot<D>(),   interruptSlot<D>(),
    activitySlot<D>(),          pointsSlot<D>()};

template <class D>
inline constexpr c3de_phyxel_set_v0 kPhyxelSetTable{sizeof(c3de_phyxel_set_v0), 1,
                                                    thunk<D, &D::count>,        thunk<D, &D::read>,
                                                    thunk<D, &D::neighbours>,   thunk<D, &D::assign>,
                                                    thunk<D, &D::move>};

template <class D>
constexpr auto trianglesSlot() -> decltype(c3de_surfel_set_v0::triangles) {
  if constexpr (kHasTriangles<D>)
    return thunk<D, &D::triangles>;
  else
    return nullptr;
}

/// Of revision 2 where Derived has triangles(), else of revision 1.
template <class D>
inline constexpr c3de_surfel_set_v0 kSurfelSetTable{
    sizeof(c3de_surfel_set_v0), kHasTriangles<D> ? 2u : 1u, thunk<D, &D::count>, thunk<D, &D::read>,
    thunk<D, &D::owners>,       thunk<D, &D::assign>,       trianglesSlot<D>()};

}  // namespace c3de::sdk
