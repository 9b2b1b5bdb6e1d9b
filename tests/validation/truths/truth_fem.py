# SPDX-License-Identifier: Apache-2.0
"""Writes models for truth_fem (folder fem), runs it and reads its results."""
import os
import pathlib
import subprocess

COMMAND = os.environ.get('TRUTH_FEM', '')


def _model(model):
    m, stages = model.mesh, len(model.stages)
    out = [f'laws {len(model.materials)}']
    out += [f'{a.law} {a.youngs_modulus!r} {a.poisson_ratio!r} {a.density!r}' for a in model.materials]
    out.append(f'nodes {len(m.nodes)}')
    out += [' '.join(repr(c) for c in at) for at in m.nodes]
    out.append(f'elements {len(m.elements)}')
    out += [f'{material} ' + ' '.join(map(str, element)) for material, element in zip(m.materials, m.elements)]
    out.append(f'stages {stages} ' + ' '.join(map(repr, model.stages)))
    out.append(f'held {len(model.held)}')
    out += [f'{node} {axis} ' + ' '.join(map(repr, values)) for (node, axis), values in sorted(model.held.items())]
    out.append(f'forces {len(model.forces)}')
    out += [f'{node} ' + ' '.join(map(repr, force)) for node, force in sorted(model.forces.items())]
    out.append(f'pressures {len(model.pressures)}')
    out += [f'{pressure!r} {face.element} ' + ' '.join(map(str, face.lattice))
            for face, pressure in model.pressures]
    out.append('gravity ' + ' '.join(map(repr, model.gravity)))
    out.append(f'increments {max(1, round(1 / model.increment))}')
    return '\n'.join(out) + '\nend\n'


def solve(model, folder, name):
    """@return displacements and internal forces {node: (x, y, z)} and the number of unknowns"""
    if not COMMAND:
        raise RuntimeError('set TRUTH_FEM to the program truth_fem')
    folder = pathlib.Path(folder)
    text, source, result = _model(model), folder / f'{name}.fem', folder / f'{name}.out'
    # Results of an earlier run of the very same model in this folder are taken as they are.
    if not (source.exists() and result.exists() and source.read_text() == text):
        result.unlink(missing_ok=True)
        source.write_text(text)
        with (folder / f'{name}.log').open('w') as log:
            status = subprocess.run([COMMAND, source.name, result.name], cwd=folder, stderr=log).returncode
        if status != 0:
            result.unlink(missing_ok=True)
            raise RuntimeError(f'truth_fem failed, see {folder}/{name}.log')
    lines = result.read_text().splitlines()
    rows = [tuple(map(float, line.split())) for line in lines[1:]]
    return dict(enumerate(r[:3] for r in rows)), dict(enumerate(r[3:] for r in rows)), int(lines[0].split()[1])
