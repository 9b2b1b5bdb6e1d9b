# SPDX-License-Identifier: Apache-2.0
"""A process of c3de.sweep(): a request as JSON on stdin, the answer on stdout."""

import json
import sys

from ._sweep import _simulate

if __name__ == "__main__":
    json.dump(_simulate(json.load(sys.stdin)), sys.stdout)
