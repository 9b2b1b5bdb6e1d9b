# SPDX-License-Identifier: Apache-2.0
"""The same scene with many values, in processes."""

import itertools
import json
import os
import pathlib
import subprocess
import sys
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any, Dict, Iterator, NamedTuple, Optional, Sequence

from . import _library as _l
from ._library import Error
from ._simulation import open as _open
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


def _simulate(request: Dict[str, Any]) -> Dict[str, Any]:
    """Answers a request in this process."""
    try:
        with _open(request["scene"], threads=request["threads"], **request["values"]) as simulation:
            simulation.run(request["until"], steps=request["steps"])
            return {"report": simulation.report()}
    except Error as error:
        return {"error": str(error), "status": error.status}


def _row(values: Dict[str, Value], answer: Dict[str, Any]) -> SweepRow:
    error = Error(answer["error"], answer["status"]) if "error" in answer else None
    return SweepRow(values, answer.get("report"), error)


def sweep(scene: Path, values: Dict[str, Sequence[Value]], until: Optional[float] = None, *, jobs: int = 1,
          steps: Optional[int] = None, executor: Optional[Executor] = None,
          threads: Optional[int] = None) -> Iterator[SweepRow]:
    """Simulates a scene for every combination of values, each in a process of its own, and yields them in order: the
    last path changes fastest.

    values: by the paths of c3de.open(). until (s), steps: as Simulation.run(). jobs: number of processes that run
    concurrently; they share the processors. A simulation that fails is a row with an error; the others continue. Ctrl-C
    ends the processes.

    executor: computes the rows instead of own processes, for example mpi4py.futures.MPIPoolExecutor() on other computers,
    which must find the package and the scene. threads: of each simulation; by default the share of a process, with an
    executor 1.
    """
    if jobs < 1:
        raise Error("jobs is %d; accepted: >= 1" % jobs, _l.E_ARG)
    if threads is None:
        threads = 1 if executor else max(1, (os.cpu_count() or 1) // jobs)
    if threads < 1:
        raise Error("threads is %d; accepted: >= 1" % threads, _l.E_ARG)
    processes: Dict[int, subprocess.Popen] = {}
    combinations = [dict(zip(values, row)) for row in itertools.product(*values.values())]
    requests = [{"scene": os.fspath(scene), "until": until, "steps": steps, "threads": threads,
                 "values": {path: _text(value) for path, value in one.items()}} for one in combinations]
    if executor:
        futures = [executor.submit(_simulate, request) for request in requests]
        try:
            for one, future in zip(combinations, futures):
                yield _row(one, future.result())
        finally:
            for future in futures:
                future.cancel()
        return
    pool = ThreadPoolExecutor(jobs)
    try:
        for one, answer in zip(combinations, pool.map(lambda request: _run(request, processes), requests)):
            yield _row(one, answer)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(processes.values()):
            process.terminate()
        pool.shutdown()
