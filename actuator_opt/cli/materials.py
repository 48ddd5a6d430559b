"""The commands of `actuator-opt materials`: library data with their sources."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..base import files as store
from ..base.errors import Diagnostic, UsageError
from . import streams
from .options import Json

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
    from ..design.material_tables import list_lines, to_dict
    from ..design.materials import load_library

    if kind is not None and kind not in KINDS:
        raise UsageError(Diagnostic(f'--kind "{kind}"', f"use one of {', '.join(KINDS)}"))
    found = load_library()
    if as_json:
        streams.out_json(to_dict(m for m in found if kind is None or m.kind == kind))
    else:
        streams.out("\n".join(list_lines(found, kind=kind, ascii=not streams.style()["unicode"])))


@materials.command("show")
def show_material(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the entry.")],
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

    For a fluid, also over temperature and pressure.
    """
    from ..design.material_tables import show_lines, to_dict
    from ..design.materials import load_library

    material = load_library().get(name)
    if out is not None:
        if material.kind != "fluid":
            message = f"--out: {name} is a {material.kind}, only fluids have a figure"
            raise UsageError(Diagnostic(message, "remove --out, or name a fluid"))
        store.require_folder(out)
    style = streams.style()
    if as_json:
        streams.out_json(to_dict([material]))
    else:
        lines = show_lines(material, ascii=not style["unicode"])
        if material.kind == "fluid":
            from ..pages.fluid_figure import table_lines

            lines += ["", *table_lines(material, **style)]
        streams.out("\n".join(lines))
    if out is not None:
        from ..pages.fluid_figure import write_figure

        for path in write_figure(material, out):
            streams.err(f"wrote {path}")


@materials.command("compare")
def compare_materials(
    names: Annotated[list[str], typer.Argument(metavar="NAME", help="Two or more entries.")],
    as_json: Json = False,
) -> None:
    """Compare properties, with ratios to the first material."""
    from ..design.material_tables import compare_lines, to_dict
    from ..design.materials import load_library

    if len(names) < 2:
        raise UsageError(Diagnostic("a comparison needs two materials", "name two or more"))

    found = load_library()
    materials = [found.get(name) for name in names]
    if as_json:
        streams.out_json(to_dict(materials))
    else:
        streams.out("\n".join(compare_lines(materials, ascii=not streams.style()["unicode"])))
