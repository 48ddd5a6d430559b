"""Files for other programs: parts as STEP, the section as DXF, results as XLSX, formulas as C."""

from .files import FORMATS, ExportFile, require_formats, write_exports, written

__all__ = ["FORMATS", "ExportFile", "require_formats", "write_exports", "written"]
