"""Files for other programs: turned parts as STEP, the section as DXF, results as XLSX."""

from .files import FORMATS, ExportFile, require_formats, write_exports

__all__ = ["FORMATS", "ExportFile", "require_formats", "write_exports"]
