"""A host of FMI 2.0 in a few lines: load the library of a unit and call its functions."""

from __future__ import annotations

import ctypes
import tempfile
import zipfile
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

REAL, TEXT, POINTER = ctypes.c_double, ctypes.c_char_p, ctypes.c_void_p
OK, ERROR = 0, 3
LOGGER = ctypes.CFUNCTYPE(None, POINTER, TEXT, ctypes.c_int, TEXT, TEXT, TEXT)
ALLOCATE = ctypes.CFUNCTYPE(POINTER, ctypes.c_size_t, ctypes.c_size_t)
FREE = ctypes.CFUNCTYPE(None, POINTER)
_C = ctypes.CDLL(None)
_C.calloc.restype, _C.calloc.argtypes = POINTER, [ctypes.c_size_t, ctypes.c_size_t]
_C.free.argtypes = [POINTER]


class Callbacks(ctypes.Structure):
    """The callbacks of FMI 2.0."""

    _fields_ = (
        ("logger", LOGGER), ("allocate", ALLOCATE), ("free", FREE), ("finished", POINTER),
        ("environment", POINTER),
    )  # fmt: skip


class Unit:
    """A unit, opened from its archive; messages of its logger are in `said`."""

    def __init__(self, file, folder, *, guid=None, kind=1, memory=True):
        folder = Path(tempfile.mkdtemp(dir=folder))  # a library in use must not be overwritten
        with zipfile.ZipFile(file) as archive:
            archive.extractall(folder)
        self.xml = ElementTree.parse(folder / "modelDescription.xml").getroot()
        self.name = self.xml.get("modelName")
        self.library = ctypes.CDLL(str(folder / f"binaries/linux64/{self.name}.so"))
        self.variables = {x.get("name"): x for x in self.xml.find("ModelVariables")}
        self.said = []
        self.live = 0
        self.callbacks = Callbacks(
            LOGGER(lambda *parts: self.said.append(parts[5].decode())),
            ALLOCATE(self._allocate if memory else lambda *sizes: None),
            FREE(self._free), None, None,
        )  # fmt: skip
        make = self.library.fmi2Instantiate
        make.restype = POINTER
        make.argtypes = [TEXT, ctypes.c_int, TEXT, TEXT, POINTER, ctypes.c_int, ctypes.c_int]
        guid = self.xml.get("guid") if guid is None else guid
        self.component = make(
            b"unit", kind, guid.encode(), b"", ctypes.addressof(self.callbacks), 0, 0
        )

    def _allocate(self, count, size):
        self.live += 1
        return _C.calloc(count, size)

    def _free(self, memory):
        self.live -= 1
        _C.free(memory)

    def call(self, function, *arguments):
        """Status of a function."""
        named = getattr(self.library, f"fmi2{function}")
        return named(POINTER(self.component), *arguments)

    def setup(self, start=0.0, tolerance=None):
        """Status of fmi2SetupExperiment."""
        given = int(tolerance is not None)
        return self.call("SetupExperiment", given, REAL(tolerance or 0), REAL(start), 0, REAL(0))

    def begin(self, **values):
        """Set values by name (with "__" for a point), and end the initialisation."""
        assert self.setup() == OK
        for name, value in values.items():
            assert self.set(name.replace("__", "."), value) == OK
        assert self.call("EnterInitializationMode") == OK
        assert self.call("ExitInitializationMode") == OK
        return self

    def references(self, names):
        """References of variables as an array of C."""
        numbers = [int(self.variables[name].get("valueReference")) for name in names]
        return (ctypes.c_uint * len(numbers))(*numbers)

    def set(self, name, value):
        """Status of fmi2SetReal."""
        return self.call(
            "SetReal", self.references([name]), ctypes.c_size_t(1), ctypes.byref(REAL(value))
        )

    def get(self, *names):
        """Values of variables."""
        values = (REAL * len(names))()
        assert (
            self.call("GetReal", self.references(names), ctypes.c_size_t(len(names)), values) == 0
        )
        return np.array(values)

    def step(self, time, size):
        """Status of fmi2DoStep."""
        return self.call("DoStep", REAL(time), REAL(size), 1)

    def run(self, times, *names):
        """Values at times, of which the first is the present one: an array (times, names)."""
        rows = [self.get(*names)]
        for begin, end in pairwise(times):
            assert self.step(begin, end - begin) == OK, self.said
            rows.append(self.get(*names))
        return np.array(rows)

    def close(self):
        """Free the instance."""
        self.library.fmi2FreeInstance(POINTER(self.component))
