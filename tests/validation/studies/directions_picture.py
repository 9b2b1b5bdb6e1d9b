#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the errors of a beam over the directions of its lattice, for docs/theory/lattice.md.

    build/release/bin/test_truths "thirty random directions*" > directions.txt
    python3 tests/validation/studies/directions_picture.py directions.txt docs/theory/images/directions.svg

Directions are sorted by the error of first order.
"""
import re
import sys

ROW = re.compile(r"(beam_shear|beam_twist)\.stvk, (\d) layers, (first|second) order, (\d+) .* (\S+) ± \S+ +(\S+) ")
PANELS = [("beam_shear", 3, "tip, 3 layers"), ("beam_twist", 3, "torque, 3 layers"),
          ("beam_shear", 5, "tip, 5 layers"), ("beam_twist", 5, "torque, 5 layers")]
COLOURS = {"first": "#c0392b", "second": "#1f77b4"}
WIDTH, HEIGHT, LIMIT = 330, 190, 11.0  # of a panel, px; largest error, %


def errors_of(lines):
    found = {}
    for line in lines:
        row = ROW.match(line)
        if row:
            case, layers, order, direction, truth, ours = row.groups()
            error = 100.0 * (float(ours) / float(truth) - 1.0)
            found.setdefault((case, int(layers), order), {})[int(direction)] = error
    return found


def panel(found, case, layers, title, left, top):
    first = found[case, layers, "first"]
    sequence = sorted(first, key=first.get)
    def y(error):
        return top + HEIGHT * (0.5 - 0.5 * error / LIMIT)
    out = [f'<text x="{left}" y="{top - 8}" font-weight="bold">{title}</text>']
    for error in (-10, -5, 0, 5, 10):
        shade = "#444" if error == 0 else "#ddd"
        out.append(f'<line x1="{left}" x2="{left + WIDTH}" y1="{y(error):.1f}" y2="{y(error):.1f}" stroke="{shade}"/>')
        out.append(f'<text x="{left - 6}" y="{y(error) + 4:.1f}" text-anchor="end">{error:+d} %</text>'.replace("+0", "0"))
    for order, colour in COLOURS.items():
        errors = found[case, layers, order]
        for place, direction in enumerate(sequence):
            x = left + WIDTH * (place + 0.5) / len(sequence)
            out.append(f'<circle cx="{x:.1f}" cy="{y(errors[direction]):.1f}" r="3.2" fill="{colour}"/>')
    return out


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        found = errors_of(file)
    if len(found) != 8 or len({len(rows) for rows in found.values()}) != 1:
        sys.exit(f"{sys.argv[1]}: not the output of all directions")
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="840" height="520" font-family="sans-serif" font-size="12">',
           '<rect width="840" height="520" fill="white"/>']
    for k, (case, layers, title) in enumerate(PANELS):
        out += panel(found, case, layers, title, 70 + 400 * (k % 2), 40 + 240 * (k // 2))
    for k, (order, colour) in enumerate(COLOURS.items()):
        out.append(f'<circle cx="{80 + 160 * k}" cy="500" r="4" fill="{colour}"/>')
        out.append(f'<text x="{90 + 160 * k}" y="504">{order} order</text>')
    out.append('<text x="400" y="504">one point per direction, sorted by the error of first order</text>')
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("\n".join(out + ["</svg>"]) + "\n")


if __name__ == "__main__":
    main()
