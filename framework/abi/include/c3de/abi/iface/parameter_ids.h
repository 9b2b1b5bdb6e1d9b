/* SPDX-License-Identifier: Apache-2.0 */
/* Ids of parameters that mean the same with every simulator. Scenes name them, the window sets them; a simulator
 * declares those that it serves, beside its own. */
#ifndef C3DE_ABI_IFACE_PARAMETER_IDS_H
#define C3DE_ABI_IFACE_PARAMETER_IDS_H

/* Of the world. */
#define C3DE_PARAM_ID_GRAVITY "world.gravity"         /* VEC3, m/s^2 */
#define C3DE_PARAM_ID_BOX_MIN "world.box.min"         /* VEC3, m: walls that keep bodies inside */
#define C3DE_PARAM_ID_BOX_MAX "world.box.max"         /* VEC3, m */
#define C3DE_PARAM_ID_BOX_ENABLED "world.box.enabled" /* BOOL */
#define C3DE_PARAM_ID_DAMPING "solver.damping"        /* F64, 1/s: rate at which velocities decay */
#define C3DE_PARAM_ID_ERROR_PERCENT \
  "accuracy.error_percent"                           /* F64 or "auto": how far off bodies may be, % of their
                                                              * largest displacement; in the place of sampling */
#define C3DE_PARAM_ID_ERROR_MM "accuracy.error_mm"   /* F64, mm, or "auto": the same in mm; one of the three at most */
#define C3DE_PARAM_ID_BUDGET_MS "accuracy.budget_ms" /* F64, ms, or "auto": what 1/60 s of simulated time may take */
#define C3DE_PARAM_ID_ACCURACY_BODIES "accuracy.bodies" /* I64: how many bodies share the budget; the host says it */
#define C3DE_PARAM_ID_CONTACT_ENABLED "contact.enabled" /* BOOL: bodies touch each other */
#define C3DE_PARAM_ID_CONTACT_SELF "contact.self"       /* BOOL: and themselves */
#define C3DE_PARAM_ID_CONTACT_FRICTION \
  "contact.friction" /* F64, Coulomb: between bodies, and of bodies with themselves */

/* Of a body. */
#define C3DE_PARAM_ID_DENSITY "material.density"                         /* F64, kg/m^3 */
#define C3DE_PARAM_ID_YOUNGS_MODULUS "material.youngs_modulus"           /* F64, Pa, at small strain */
#define C3DE_PARAM_ID_YOUNGS_MODULUS_LOW "material.youngs_modulus_low"   /* F64, Pa, or "auto": where that of such */
#define C3DE_PARAM_ID_YOUNGS_MODULUS_HIGH "material.youngs_modulus_high" /* tissue begins and ends; changes nothing */
#define C3DE_PARAM_ID_POISSON_RATIO "material.poisson_ratio"             /* F64, at small strain */
#define C3DE_PARAM_ID_SPACING "sampling.spacing"                         /* F64, m, between points */
#define C3DE_PARAM_ID_COUNT "sampling.count"                             /* I64, points, about */
#define C3DE_PARAM_ID_RIGID "rigid"                                      /* BOOL: stands still and is touched */
#define C3DE_PARAM_ID_FREE "free"                                        /* BOOL: a rigid body moves with its mass */
#define C3DE_PARAM_ID_SURROUNDINGS_STIFFNESS "surroundings.stiffness"    /* F64, Pa/m: elastic layer about it */

/* Of an obstacle. */
#define C3DE_PARAM_ID_FRICTION "friction"       /* F64, Coulomb's coefficient */
#define C3DE_PARAM_ID_RESTITUTION "restitution" /* F64, 0 ... 1 */

#endif
