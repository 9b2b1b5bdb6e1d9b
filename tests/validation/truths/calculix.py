# SPDX-License-Identifier: Apache-2.0
"""Writes CalculiX decks, runs ccx and reads its printed results."""
import os
import pathlib
import re
import subprocess

import mesh as meshing

COMMAND = os.environ.get('CCX', 'ccx')


def _rows(values, per_line):
    return '\n'.join(', '.join(values[i:i + per_line]) + (',' if i + per_line < len(values) else '')
                     for i in range(0, len(values), per_line))


def deck(model, title):
    """Text of the input deck. Nodes and elements are numbered from one."""
    m, out = model.mesh, ['*HEADING', title]
    out.append('*NODE, NSET=NALL')
    out += [f'{n + 1}, ' + ', '.join(f'{c:.9g}' for c in m.nodes[n]) for n in m.used(20)]
    for material in range(len(model.materials)):
        out.append(f'*ELEMENT, TYPE={model.element}, ELSET=E{material}')
        for e, element in enumerate(m.elements):
            if m.materials[e] == material:
                out.append(_rows([str(e + 1)] + [str(element[n] + 1) for n in meshing.SERENDIPITY], 15))
    for i, material in enumerate(model.materials):
        out.append(f'*MATERIAL, NAME=M{i}')
        if material.law == 'isochoric':
            mu = material.youngs_modulus / (2 * (1 + material.poisson_ratio))
            kappa = material.youngs_modulus / (3 * (1 - 2 * material.poisson_ratio))
            out += ['*HYPERELASTIC, NEO HOOKE', f'{mu / 2:.12g}, {2 / kappa:.12g}']
        else:
            out += ['*ELASTIC', f'{material.youngs_modulus:.12g}, {material.poisson_ratio:.12g}']
        out += ['*DENSITY', f'{material.density:.12g}', f'*SOLID SECTION, ELSET=E{i}, MATERIAL=M{i}']
    out.append('*ELSET, ELSET=EALL')
    out += [f'E{i}' for i in range(len(model.materials))]
    if model.frequencies:
        out.append('*BOUNDARY')
        out += [f'{node + 1}, {axis + 1}' for node, axis in sorted(model.held)]
        out += ['*STEP', '*FREQUENCY', f'{model.frequencies}', '*END STEP']
        return '\n'.join(out) + '\n'
    for stage, factor in enumerate(model.stages):
        nlgeom = ', NLGEOM, INC=1000' if model.law != 'linear' else ''
        out += ['*STEP' + nlgeom, '*STATIC', f'{model.increment:g}, 1.0, 1e-6, {max(model.increment, 0.25):g}']
        out.append('*BOUNDARY')
        out += [f'{node + 1}, {axis + 1}, {axis + 1}, {values[stage]:.12g}'
                for (node, axis), values in sorted(model.held.items()) if stage == 0 or any(values)]
        if model.forces:
            out.append('*CLOAD')
            out += [f'{node + 1}, {axis + 1}, {factor * value:.12g}'
                    for node, force in sorted(model.forces.items()) for axis, value in enumerate(force) if value]
        if any(model.gravity):
            size = sum(g * g for g in model.gravity) ** 0.5
            out += ['*DLOAD', f'EALL, GRAV, {factor * size:.12g}, ' +
                    ', '.join(f'{g / size:.12g}' for g in model.gravity)]
        if model.pressures:
            out.append('*DLOAD')
            out += [f'{face.element + 1}, P{face.number}, {factor * pressure:.12g}' for face, pressure in model.pressures]
        if stage + 1 == len(model.stages):
            out += ['*NODE PRINT, NSET=NALL, FREQUENCY=1000', 'U, RF']
        out.append('*END STEP')
    return '\n'.join(out) + '\n'


def _run(text, folder, name):
    """Printed results of the deck; those of an earlier run of the very same deck in this folder are taken as they are."""
    folder = pathlib.Path(folder)
    source, log, printed = (folder / f'{name}.{ending}' for ending in ('inp', 'log', 'dat'))
    known = all(p.exists() for p in (source, log, printed))
    if known and source.read_text() == text and 'Job finished' in log.read_text():
        return printed.read_text()
    for stale in (log, printed):
        stale.unlink(missing_ok=True)
    source.write_text(text)
    with log.open('w') as stream:
        status = subprocess.run([COMMAND, '-i', name], cwd=folder, stdout=stream, stderr=subprocess.STDOUT,
                                env=dict(os.environ, OMP_NUM_THREADS='1')).returncode
    said = log.read_text()
    if status != 0 or '*ERROR' in said or 'Job finished' not in said:
        raise RuntimeError(f'ccx failed, see {log}')
    return printed.read_text()


def _blocks(text, title):
    """Tables of numbers, one per output of `title`, as {node: (x, y, z)}."""
    out, table = [], None
    for line in text.splitlines():
        if line.startswith(' ' + title):
            table = {}
            out.append(table)
        elif table is not None and line.strip():
            words = line.split()
            if not words[0].isdigit():
                table = None
            else:
                table[int(words[0]) - 1] = tuple(float(w) for w in words[1:4])
    return out


def solve(model, folder, name):
    """@return displacements and internal forces {node: (x, y, z)} and the number of unknowns"""
    text = _run(deck(model, name), folder, name)
    unknowns = 3 * len(model.mesh.used(20)) - sum(1 for node, _ in model.held)
    return _blocks(text, 'displacements')[-1], _blocks(text, 'forces')[-1], unknowns


def frequencies(model, folder, name):
    """@return natural frequencies in Hz, ascending, and the number of unknowns"""
    text = _run(deck(model, name), folder, name)
    found, inside = [], False
    for line in text.splitlines():
        if 'E I G E N V A L U E   O U T P U T' in line:
            inside = True
        elif 'P A R T I C I P A T I O N' in line:
            inside = False
        elif inside:
            match = re.match(r'\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)\s*$', line)
            if match:
                found.append(float(match.group(3)))
    return found, 3 * len(model.mesh.used(20)) - len(model.held)
