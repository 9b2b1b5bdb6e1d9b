# SPDX-License-Identifier: Apache-2.0
"""All cases in their order."""
import case
import cases_beams
import cases_blocks
import cases_bodies

cases_beams.add_beams()
cases_blocks.add_cubes()
cases_bodies.add_bodies()
cases_bodies.add_tube()
cases_blocks.add_indentations()
cases_blocks.add_embedded_punches()
cases_beams.add_pressures()
cases_beams.add_two_materials()
cases_beams.add_slanted_bar()
cases_bodies.add_torsion()
cases_bodies.add_free_vibrations()
ALL = case.ALL
