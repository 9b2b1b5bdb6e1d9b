// SPDX-License-Identifier: Apache-2.0
// Tables of the simulation interfaces from classes whose members carry the slots' names in lowerCamelCase.
#pragma once

#include "c3de/sdk/object.hpp"

namespace c3de::sdk {

// Asked of the class and not of the slot: with UBSan GCC does not count a comparison of function pointers as constant.
// A slot that may be null is filled where Derived has the member.
#define C3DE_SDK_OPTIONAL_SLOT(slot, member)                         \
  template <class D>                                                 \
  constexpr auto member##Slot()->decltype(c3de_simulator_v1::slot) { \
    if constexpr (requires { &D::member; })                          \
      return thunk<D, &D::member>;                                   \
    else                                                             \
      return nullptr;                                                \
  }

C3DE_SDK_OPTIONAL_SLOT(displacement, displacement)
C3DE_SDK_OPTIONAL_SLOT(interrupt, interrupt)
C3DE_SDK_OPTIONAL_SLOT(activity, activity)
C3DE_SDK_OPTIONAL_SLOT(points, points)
C3DE_SDK_OPTIONAL_SLOT(add_load, addLoad)
C3DE_SDK_OPTIONAL_SLOT(hold, hold)
C3DE_SDK_OPTIONAL_SLOT(pull, pull)
C3DE_SDK_OPTIONAL_SLOT(hold_state, holdState)
C3DE_SDK_OPTIONAL_SLOT(save_state, saveState)
C3DE_SDK_OPTIONAL_SLOT(load_state, loadState)
C3DE_SDK_OPTIONAL_SLOT(verify, verify)

#undef C3DE_SDK_OPTIONAL_SLOT

/// Static table of iface.simulator for an Object<Derived>: every slot that may not be null has a member function of
/// Derived (see thunk), those that may be where Derived has one. addBody() has to serve fixes, loads, parts,
/// refinements, velocities and, with displacement(), `fill`, or refuse them:
///
///   static std::array<Interface, 1> interfaces() { return {interfaceOf(kSimulatorTable<WorldSimulator>)}; }
template <class D>
inline constexpr c3de_simulator_v1 kSimulatorTable{sizeof(c3de_simulator_v1),
                                                   1,
                                                   thunk<D, &D::attach>,
                                                   thunk<D, &D::declarations>,
                                                   thunk<D, &D::setWorld>,
                                                   thunk<D, &D::addBody>,
                                                   thunk<D, &D::addObstacle>,
                                                   thunk<D, &D::addProbe>,
                                                   thunk<D, &D::setBodyParam>,
                                                   thunk<D, &D::getBodyParam>,
                                                   thunk<D, &D::remove>,
                                                   thunk<D, &D::clear>,
                                                   thunk<D, &D::step>,
                                                   thunk<D, &D::reset>,
                                                   thunk<D, &D::publish>,
                                                   thunk<D, &D::status>,
                                                   thunk<D, &D::stateHash>,
                                                   thunk<D, &D::report>,
                                                   thunk<D, &D::bodyAt>,
                                                   thunk<D, &D::bodyInfo>,
                                                   thunk<D, &D::enumFields>,
                                                   thunk<D, &D::readField>,
                                                   thunk<D, &D::triangles>,
                                                   thunk<D, &D::enumProbes>,
                                                   displacementSlot<D>(),
                                                   interruptSlot<D>(),
                                                   activitySlot<D>(),
                                                   pointsSlot<D>(),
                                                   addLoadSlot<D>(),
                                                   holdSlot<D>(),
                                                   pullSlot<D>(),
                                                   holdStateSlot<D>(),
                                                   saveStateSlot<D>(),
                                                   loadStateSlot<D>(),
                                                   verifySlot<D>()};

/// Static table of iface.contact, likewise: setPair(), addProbeTool() and enumProbeTools().
template <class D>
inline constexpr c3de_contact_v1 kContactTable{sizeof(c3de_contact_v1), 1, thunk<D, &D::setPair>,
                                               thunk<D, &D::addProbeTool>, thunk<D, &D::enumProbeTools>};

/// Static table of iface.attachment, likewise: addAttachment() and enumAttachments().
template <class D>
inline constexpr c3de_attachment_v1 kAttachmentTable{sizeof(c3de_attachment_v1), 1, thunk<D, &D::addAttachment>,
                                                     thunk<D, &D::enumAttachments>};

/// Static table of iface.grasp, likewise: addGrasp().
template <class D>
inline constexpr c3de_grasp_v1 kGraspTable{sizeof(c3de_grasp_v1), 1, thunk<D, &D::addGrasp>};

/// Static table of iface.changes, likewise: observeChanges() and applyChange().
template <class D>
inline constexpr c3de_changes_v1 kChangesTable{sizeof(c3de_changes_v1), 1, thunk<D, &D::observeChanges>,
                                               thunk<D, &D::applyChange>};

}  // namespace c3de::sdk
