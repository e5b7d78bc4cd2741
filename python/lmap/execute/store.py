"""Results on disk, by content: a case that has run is not run again.

    <folder>/<fingerprint of the core>/<hash of the case>.parquet    the frame
    <folder>/<fingerprint of the core>/<hash of the case>.json       how the run ended; written last
    <folder>/<fingerprint of the core>/<key>.note                    what was read from frames: verdicts, channels

Every file is written under a temporary name and renamed, and begins with or is accompanied by its checksum: what a
killed process, a full disk or a hand leaves behind is taken for missing and made again.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import tempfile
import time
import weakref
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap import files
from lmap.errors import LmapError
from lmap.verdict import Extent

if TYPE_CHECKING:
    import polars as pl

    from lmap.execute.local import CaseOutcome

FOLDER_VARIABLE = "LMAP_CACHE_DIR"
SIZE_VARIABLE = "LMAP_CACHE_GB"
MOST_GB = 10.0
"""Room that results may take, unless `LMAP_CACHE_GB` says otherwise."""
KEPT_SHARE = 0.8
"""How full a cache is left that had become too full: it is not emptied file by file at every check."""
STALE_S = 3600.0
"""A temporary file older than this was left by a process that was killed."""
FORMAT = 1
_ROWS = 4096
"""In a group of a parquet file: what is written is collected group by group."""


class LostFrame(LmapError):
    """A frame that was on disk cannot be read any more."""

    def __init__(self, case_hash: str) -> None:
        super().__init__(
            f"the stored result of case {case_hash[:12]} cannot be read any more: run the check again"
        )
        self.case_hash = case_hash


def default_folder() -> Path:
    """`LMAP_CACHE_DIR`, else the user's cache folder as the platform has it."""
    import platformdirs

    given = os.environ.get(FOLDER_VARIABLE)
    return Path(given) if given else platformdirs.user_cache_path("lmap", appauthor=False)


@dataclass(frozen=True, slots=True)
class StoredFrame:
    """A frame on disk."""

    path: Path
    sha256: str
    case_hash: str
    store: Store = field(repr=False, compare=False)
    """Whose file it is: a temporary store lasts as long as its frames are asked for."""

    def read(self) -> pl.DataFrame:
        """The frame; `LostFrame` where the file is not what was written."""
        import polars as pl

        held = self.store.held.get(self.case_hash)
        if held is not None:
            return held
        try:
            with self.path.open("rb") as stream:
                whole = hashlib.file_digest(stream, "sha256").hexdigest() == self.sha256
            if whole:  # read from the file: its bytes are never in memory beside the frame
                return pl.read_parquet(self.path, memory_map=False)
        except (OSError, pl.exceptions.PolarsError):
            pass
        raise LostFrame(self.case_hash)


class Store:
    """A folder of results of one core; `Store.temporary` is gone with its last user."""

    def __init__(self, folder: Path, core: str) -> None:
        self.root = folder.absolute()  # the working folder may be another one while an FMU is loaded
        self.folder = self.root / hashlib.sha256(core.encode()).hexdigest()[:16]
        self.held: dict[str, pl.DataFrame] = {}
        """Frames that somebody holds just now, by hash: the disk is not asked for these."""

    @classmethod
    def temporary(cls, core: str) -> Store:
        """A store for one check: results stay out of memory, and nothing is found in it."""
        store = cls(Path(tempfile.mkdtemp(prefix="lmap.")), core)
        weakref.finalize(store, shutil.rmtree, store.root, ignore_errors=True)
        return store

    # ---- outcomes of cases

    def outcome(self, case_hash: str) -> CaseOutcome | None:
        """What a case gave before, its frame left on disk; nothing where it is not known or not whole."""
        from lmap.execute.local import CaseOutcome

        path, note = self._frame(case_hash), self.folder / f"{case_hash}.json"
        written = _unsealed(note)
        try:
            if written is None or path.stat().st_size != written["size"]:
                return None
            outcome = CaseOutcome(
                StoredFrame(path, written["sha256"], case_hash, self),
                written["ended"],
                written["statistics"],
                float(written["wall_s"]),
                Extent(**written["extent"]),
                stored=True,
            )
        except (OSError, KeyError, TypeError, ValueError):
            return None
        for one in (path, note):
            with contextlib.suppress(OSError):
                os.utime(one)  # asked for lately: the last to go when room is made
        return outcome

    def keep(self, case_hash: str, outcome: CaseOutcome) -> CaseOutcome:
        """The same outcome with its frame on disk; as it was where nothing can be written or nothing ran."""
        from lmap.execute.local import CaseOutcome

        frame = outcome.frame
        if frame is None:
            return outcome
        path = self._frame(case_hash)
        sums: list[str] = []

        def write(temporary: Path) -> None:
            # light compression: doubles hardly shrink, and nobody waits for this
            frame.write_parquet(temporary, compression="lz4", statistics=False, row_group_size=_ROWS)
            with temporary.open("rb") as stream:
                sums.append(hashlib.file_digest(stream, "sha256").hexdigest())

        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            files.put(path, write)
            extent = Extent.of(frame)
            record = {
                "size": path.stat().st_size,
                "sha256": sums[0],
                "ended": dict(outcome.ended),
                "statistics": dict(outcome.statistics),
                "wall_s": outcome.wall_s,
                "extent": asdict(extent),
            }
            _seal(self.folder / f"{case_hash}.json", record)
        except OSError:
            return outcome
        stored = StoredFrame(path, sums[0], case_hash, self)
        return CaseOutcome(stored, outcome.ended, outcome.statistics, outcome.wall_s, extent)

    @contextlib.contextmanager
    def holding(self, case_hash: str, frame: pl.DataFrame | None) -> Iterator[None]:
        """Within, a frame that was kept is the one in memory: who judges it at once does not read it back."""
        if frame is not None:
            self.held[case_hash] = frame
        try:
            yield
        finally:
            self.held.pop(case_hash, None)

    def drop(self, case_hash: str) -> None:
        """Forgets a case."""
        for path in (self.folder / f"{case_hash}.json", self._frame(case_hash)):
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)

    def _frame(self, case_hash: str) -> Path:
        return self.folder / f"{case_hash}.parquet"

    # ---- notes

    def note(self, key: str) -> Any:
        """Plain data kept under a key; nothing where there is none."""
        path = self.folder / f"{key}.note"
        found = _unsealed(path)
        if found is not None:
            with contextlib.suppress(OSError):
                os.utime(path)
        return found

    def write_note(self, key: str, value: Any) -> None:
        """Keeps plain data under a key; nothing happens where it cannot be written."""
        with contextlib.suppress(OSError):
            self.folder.mkdir(parents=True, exist_ok=True)
            _seal(self.folder / f"{key}.note", value)

    # ---- room

    def make_room(self) -> None:
        """Removes what was asked for least recently, where the folder has become too large."""
        limit = limit_bytes()
        entries = sorted(_entries(self.root), key=lambda entry: entry[1])
        used = sum(size for _, _, size in entries)
        now = time.time()
        for path, asked, size in entries:
            left_over = path.name.endswith(".tmp") and now - asked > STALE_S
            if left_over or used > limit:
                with contextlib.suppress(OSError):
                    path.unlink()
                    used -= size
                if used <= KEPT_SHARE * limit:
                    limit = max(limit, used)


def limit_bytes() -> float:
    """Room that results may take, bytes."""
    try:
        return float(os.environ.get(SIZE_VARIABLE, "")) * 1e9
    except ValueError:
        return MOST_GB * 1e9


@dataclass(frozen=True, slots=True)
class Usage:
    """What lies in a folder of results."""

    cases: int
    size: int
    """Bytes, of everything in it."""
    cores: int
    """Fingerprints that results are of."""


def usage(folder: Path) -> Usage:
    """Counts what is there."""
    entries = list(_entries(folder))
    return Usage(
        cases=sum(path.suffix == ".parquet" for path, _, _ in entries),
        size=sum(size for _, _, size in entries),
        cores=len({path.parent for path, _, _ in entries}),
    )


def clear(folder: Path) -> Usage:
    """Removes results, and nothing else that may lie in the folder; what was there."""
    was = usage(folder)
    for path, _, _ in list(_entries(folder)):
        with contextlib.suppress(OSError):
            path.unlink()
    for core in list(_cores(folder)):
        with contextlib.suppress(OSError):
            core.rmdir()
    return was


def _cores(folder: Path) -> Iterator[Path]:
    """Folders whose names are fingerprints."""
    with contextlib.suppress(OSError):
        for path in sorted(folder.iterdir()):
            if len(path.name) == 16 and not set(path.name) - set("0123456789abcdef") and path.is_dir():
                yield path


def _entries(folder: Path) -> Iterator[tuple[Path, float, int]]:
    """Files of results, when each was last asked for and how large it is."""
    for core in _cores(folder):
        for path in core.iterdir():
            if path.suffix in (".parquet", ".json", ".note", ".tmp"):
                with contextlib.suppress(OSError):
                    stat = path.stat()
                    yield path, stat.st_mtime, stat.st_size


def _seal(path: Path, value: Any) -> None:
    """Writes plain data with its checksum in front."""
    text = json.dumps({"format": FORMAT, "value": value}, ensure_ascii=False)
    files.write(path, f"{files.sha256(text)}\n{text}".encode())


def _unsealed(path: Path) -> Any:
    """Plain data as it was written, or nothing."""
    try:
        seal, _, text = path.read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    if files.sha256(text) != seal:
        return None
    document: Mapping[str, Any] = json.loads(text)
    return document["value"] if document.get("format") == FORMAT else None
