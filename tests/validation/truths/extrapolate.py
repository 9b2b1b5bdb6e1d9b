# SPDX-License-Identifier: Apache-2.0
"""Limit of a value under mesh refinement, and how far it can be trusted."""

# ccx prints six or seven digits; sums of many reactions lose a little.
PRINTED = 2e-6


def extrapolate(levels):
    """Fits v + c h^p through three meshes, h = 1/level.

    @param levels  [(level, value)], level proportional to the number of elements along an edge, ascending
    @return value and uncertainty. Where the values approach monotonously with an order p between 0.7 and 6: the limit, and
            its distance from the finest mesh. Slower: the finest value, and how far an order of 0.7 would still lead.
            Faster: the finest value and the last change. Not monotonous: the finest value, and the last change or half
            the spread of all. Never less than what the printed digits carry.
    """
    (n1, v1), (n2, v2), (n3, v3) = levels
    printed = PRINTED * abs(v3)
    a, b = v2 - v1, v3 - v2
    if abs(a) < 10 * printed and abs(b) < 10 * printed:  # converged to what is printed
        return v3, max(printed, abs(a), abs(b))
    if a * b <= 0:
        return v3, max(printed, abs(b), 0.5 * (max(v1, v2, v3) - min(v1, v2, v3)))

    def ratio(p):
        return (n2 ** -p - n3 ** -p) / (n1 ** -p - n2 ** -p)

    def remainder(p):
        return b * n3 ** -p / (n2 ** -p - n3 ** -p)

    low, high = 0.7, 6.0
    if b / a > ratio(low):
        return v3, max(printed, abs(remainder(low)))
    if b / a < ratio(high):
        return v3, max(printed, abs(b))
    for _ in range(60):
        middle = 0.5 * (low + high)
        if ratio(middle) > b / a:
            low = middle
        else:
            high = middle
    return v3 + remainder(low), max(printed, abs(remainder(low)))
