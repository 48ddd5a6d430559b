"""Files for other programs: STEP of turned parts, DXF of the section, XLSX of the results."""

from .files import FORMATS, ExportFile, require_formats, write_exports

__all__ = ["FORMATS", "ExportFile", "require_formats", "write_exports"]
