# SPDX-License-Identifier: Apache-2.0
"""The same scene with many values, in processes."""

import itertools
import json
import os
import pathlib
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Dict, Iterator, NamedTuple, Optional, Sequence

from . import _library as _l
from ._library import Error
from ._values import Path, Value, _text


class SweepRow(NamedTuple):
    """One simulation of a sweep.

    - values: by path
    - report: of the end state, as Simulation.report(); None after an error
    - error: why there is no report; None otherwise
    """
    values: Dict[str, Value]
    report: Optional[Dict[str, Any]]
    error: Optional[Error]

    def __repr__(self) -> str:
        values = ", ".join("%s = %s" % pair for pair in self.values.items())
        end = "%s after %d steps" % (self.report["outcome"], self.report["steps"]) if self.report else str(self.error)
        return "<c3de.SweepRow %s: %s>" % (values, end)


def _run(request: Dict[str, Any], processes: Dict[int, subprocess.Popen]) -> Dict[str, Any]:
    package = str(pathlib.Path(__file__).resolve().parents[1])
    environment = dict(os.environ)
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, [package, environment.get("PYTHONPATH", "")]))
    process = subprocess.Popen([sys.executable, "-m", "c3de._worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, env=environment)
    processes[process.pid] = process
    try:
        out, errors = process.communicate(json.dumps(request))
    finally:
        del processes[process.pid]
    if process.returncode != 0:
        return {"error": "the process of a simulation ended with %d: %s" % (process.returncode, errors.strip()[-500:]),
                "status": -17}
    return json.loads(out)


def sweep(scene: Path, values: Dict[str, Sequence[Value]], until: Optional[float] = None, *, jobs: int = 1,
          steps: Optional[int] = None) -> Iterator[SweepRow]:
    """Simulates a scene for every combination of values, each in a process of its own, and yields them in order: the
    last path changes fastest.

    values: by the paths of c3de.open(). until (s), steps: as Simulation.run(). jobs: number of processes that run
    concurrently; they share the processors. A simulation that fails is a row with an error; the others continue. Ctrl-C
    ends the processes.
    """
    if jobs < 1:
        raise Error("jobs is %d; accepted: >= 1" % jobs, _l.E_ARG)
    threads = max(1, (os.cpu_count() or 1) // jobs)
    processes: Dict[int, subprocess.Popen] = {}
    combinations = [dict(zip(values, row)) for row in itertools.product(*values.values())]
    requests = [{"scene": os.fspath(scene), "until": until, "steps": steps, "threads": threads,
                 "values": {path: _text(value) for path, value in one.items()}} for one in combinations]
    pool = ThreadPoolExecutor(jobs)
    try:
        for one, answer in zip(combinations, pool.map(lambda request: _run(request, processes), requests)):
            error = Error(answer["error"], answer["status"]) if "error" in answer else None
            yield SweepRow(one, answer.get("report"), error)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(processes.values()):
            process.terminate()
        pool.shutdown()
