#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The static truth of the hanging organ from CalculiX.

    bench_peers --organ FILE --deck DECK.inp --nodes N      writes a problem of 10-node tetrahedra
    ccx DECK                                                solves it, DECK.dat
    organ_truth.py DECK                                     mean displacement of what is below the held part, m

Several N give the limit; benchmarks/peers/organ_truths.h keeps it.
"""
import sys


def read_deck(path):
    """@return nodes {number: (x, y, z)}, elements [10 numbers], held {number}"""
    nodes, elements, held, section = {}, [], set(), ''
    for line in open(path):
        if line.startswith('*'):
            section = line.split(',')[0].strip()
            continue
        fields = line.split(',')
        if section == '*NODE':
            nodes[int(fields[0])] = tuple(map(float, fields[1:4]))
        elif section == '*ELEMENT':
            elements.append([int(f) for f in fields[1:]])
        elif section == '*BOUNDARY':
            held.add(int(fields[0]))
    return nodes, elements, held


def read_displacements(path):
    out = {}
    for line in open(path):
        fields = line.split()
        if len(fields) == 4 and fields[0].isdigit():
            out[int(fields[0])] = tuple(map(float, fields[1:]))
    return out


def volume(corners):
    a, b, c, d = corners
    u, v, w = ([p[k] - a[k] for k in range(3)] for p in (b, c, d))
    return sum(w[k] * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]) for k in range(3)) / 6


def main():
    nodes, elements, held = read_deck(sys.argv[1] + '.inp')
    u = read_displacements(sys.argv[1] + '.dat')
    total, integral = 0.0, [0.0] * 3
    for element in elements:
        if all(n in held for n in element[:4]):
            continue
        v = volume([nodes[n] for n in element[:4]])
        total += v
        # The integrals of the quadratic functions: -1/20 of the volume for corners, 1/5 for middles of edges.
        for k in range(3):
            integral[k] += v * (0.2 * sum(u[n][k] for n in element[4:]) - 0.05 * sum(u[n][k] for n in element[:4]))
    print(f'{len(nodes)} nodes, {3 * (len(nodes) - len(held))} unknowns, volume {total:.6g} m3, mean u =',
          *(f'{x / total:.7g}' for x in integral))


if __name__ == '__main__':
    main()
