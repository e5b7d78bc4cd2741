"""What people and machines read: the terminal's table, the page, JUnit XML, JSON and parquet.

Nothing here computes or judges: it reads frames and verdicts, so a report can be made again from them alone.
"""

from __future__ import annotations

from lmap.report.document import document, to_json
from lmap.report.junit import junit
from lmap.report.page import write_report

__all__ = ["document", "junit", "to_json", "write_report"]
