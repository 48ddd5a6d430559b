"""Build the machine for recorded models (C) if there is a compiler; without it, NumPy is used.

Packed documentation, if it was built (`docs/build.py`), goes into the wheel; it is not needed.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

FOLDER = "actuator_opt/base/symbolic"
DOCUMENTATION = "docs/_build/docs.tar.xz"
FLAGS = ["-O3", "-fno-math-errno", "-ffp-contract=off"]
"""Each operation is rounded as in NumPy (no fused products), so that results agree."""


class MachineHook(BuildHookInterface):
    """Compiles `machine.c`: into the wheel, or beside its source for an editable installation."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, and name the file and the platform in the wheel."""
        if self.target_name != "wheel":
            return
        pages = Path(self.root) / DOCUMENTATION
        if version != "editable" and pages.is_file():
            build_data["force_include"][str(pages)] = f"actuator_opt/_data/{pages.name}"
        self.folder = TemporaryDirectory()  # removed when the build ends
        try:
            built = self._compiled()
        except Exception as error:  # compilers fail in many ways; none may stop the installation
            self.app.display_warning(f"machine.c was not compiled ({error}): NumPy is used")
            return
        if version == "editable":
            (Path(self.root) / FOLDER / built.name).write_bytes(built.read_bytes())
            return
        from packaging.tags import sys_tags

        build_data["force_include"][str(built)] = f"{FOLDER}/{built.name}"
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{next(sys_tags()).platform}"

    def _compiled(self) -> Path:
        """Path of the compiled module, in a temporary folder."""
        from setuptools import Distribution, Extension
        from setuptools.command.build_ext import build_ext

        source = str(Path(self.root) / FOLDER / "machine.c")
        flags = [] if sys.platform == "win32" else FLAGS
        machine = Extension("_machine", [source], extra_compile_args=flags, py_limited_api=True)
        command = build_ext(Distribution({"ext_modules": [machine]}))
        command.build_lib = command.build_temp = self.folder.name
        command.ensure_finalized()
        command.run()
        return Path(command.get_outputs()[0])
