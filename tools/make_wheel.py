#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the Python package as a wheel for every Python 3.9 or later. It has no library inside: at run time it loads the
libc3de of an installed C3DE, or the one that the variable C3DE_LIBRARY names.
Usage: make_wheel.py PACKAGE-FOLDER VERSION OUTPUT-FOLDER"""

import base64
import hashlib
import pathlib
import sys
import zipfile

METADATA = """Metadata-Version: 2.1
Name: c3de
Version: {version}
Summary: Simulations of deformable organs with C3DE
License: Apache-2.0
Requires-Python: >=3.9
Provides-Extra: arrays
Requires-Dist: numpy; extra == 'arrays'
"""
WHEEL = """Wheel-Version: 1.0
Generator: make_wheel.py
Root-Is-Purelib: true
Tag: py3-none-any
"""
FIRST_TIME = (1980, 1, 1, 0, 0, 0)  # equal files give equal bytes


def main(package: pathlib.Path, version: str, out: pathlib.Path) -> pathlib.Path:
    """Returns the file. Errors: a folder that is no package."""
    if not (package / "__init__.py").is_file():
        sys.exit(f"make_wheel: {package} has no __init__.py; accepted: the folder of the package c3de")
    info = f"c3de-{version}.dist-info"
    files = {f"c3de/{file.name}": file.read_bytes() for file in sorted(package.iterdir()) if file.is_file()}
    files[f"{info}/METADATA"] = METADATA.format(version=version).encode()
    files[f"{info}/WHEEL"] = WHEEL.encode()
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    out.mkdir(parents=True, exist_ok=True)
    wheel = out / f"c3de-{version}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, FIRST_TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content)
    return wheel


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    print(main(pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])))
