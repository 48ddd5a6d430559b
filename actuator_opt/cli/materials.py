"""Commands of `actuator-opt materials`, which show library data with their sources."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..base import files as store
from ..base.errors import Diagnostic, UsageError
from . import completion, streams
from .options import Json

if TYPE_CHECKING:
    from ..design.material import Material
    from ..rendering.blocks import Block

materials = typer.Typer(
    help="Look up materials, fluids, seal compounds and adhesives.",
    no_args_is_help=True,
)


@materials.command("list")
def list_materials(
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind", metavar="KIND", help="metal, ply, polymer, fluid, seal or adhesive."
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """List all entries with their main properties."""
    from ..design.material import KINDS
    from ..design.materials import load_library

    if kind is not None and kind not in KINDS:
        raise UsageError(Diagnostic(f'--kind "{kind}"', f"use one of {', '.join(KINDS)}"))
    library = load_library()
    if as_json:
        streams.out_json(_data(m for m in library if kind is None or m.kind == kind))
        return
    from ..pages.material import listing

    _show(listing(library, kind=kind))


@materials.command("show")
def show_material(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME", help="Name of the entry.", autocompletion=completion.materials
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Write a figure of a fluid to this folder (NAME.png, NAME.svg).",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Show all properties of an entry, with scatter and source.

    For a fluid, also show how properties vary with temperature and pressure.
    """
    from ..design.materials import load_library

    material = load_library().get(name)
    if out is not None:
        if material.kind != "fluid":
            message = f"--out: {name} is a {material.kind}, only fluids have a figure"
            raise UsageError(Diagnostic(message, "remove --out, or name a fluid"))
        store.require_folder(out)
    if as_json:
        streams.out_json(_data([material]))
    else:
        from ..pages.material import blocks

        _show(blocks(material))
    if out is not None:
        from ..pages.material import fluid_figure
        from ..rendering.paper import write_ink

        for path in write_ink(fluid_figure(material), out, material.name):
            streams.err(f"wrote {path}")


@materials.command("compare")
def compare_materials(
    names: Annotated[
        list[str],
        typer.Argument(
            metavar="NAME", help="Two or more entries.", autocompletion=completion.materials
        ),
    ],
    as_json: Json = False,
) -> None:
    """Compare properties side by side, with ratios to the first material."""
    from ..design.materials import load_library

    if len(names) < 2:
        raise UsageError(Diagnostic("a comparison needs two materials", "name two or more"))

    library = load_library()
    materials = [library.get(name) for name in names]
    if as_json:
        streams.out_json(_data(materials))
        return
    from ..pages.material import comparison

    _show(comparison(materials))


def _data(materials: Iterable[Material]) -> dict[str, object]:
    """JSON form of materials, SI."""
    return {material.name: material.to_dict() for material in materials}


def _show(blocks: Sequence[Block]) -> None:
    from ..rendering.terminal import blocks_text

    streams.out(blocks_text(blocks, **streams.style()), end="")
