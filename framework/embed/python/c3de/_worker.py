# SPDX-License-Identifier: Apache-2.0
"""A process of c3de.sweep(): a request as JSON on stdin, the answer on stdout."""

import json
import sys
from typing import Any, Dict

from . import Error, open as _open


def main() -> None:
    request = json.load(sys.stdin)
    try:
        with _open(request["scene"], threads=request["threads"], **request["values"]) as simulation:
            simulation.run(request["until"], steps=request["steps"])
            answer: Dict[str, Any] = {"report": simulation.report()}
    except Error as error:
        answer = {"error": str(error), "status": error.status}
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
