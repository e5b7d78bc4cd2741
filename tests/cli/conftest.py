"""The command line as fixtures."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from commands import Ran

from lmap.cli import app


@pytest.fixture
def lmap(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Ran]:
    """Runs a command in the working folder."""

    def run(*arguments: str) -> Ran:
        monkeypatch.setattr(sys, "argv", ["lmap", *arguments])
        capfd.readouterr()
        with pytest.raises(SystemExit) as left:
            app.main()
        out, err = capfd.readouterr()
        assert isinstance(left.value.code, int)
        return Ran(left.value.code, out, err)

    return run


@pytest.fixture
def refused(lmap: Callable[..., Ran]) -> Callable[..., list[str]]:
    """The messages of a command that is refused; asserts that it left with 2, gave nothing and wrote nothing here."""

    def run(*arguments: str) -> list[str]:
        before = sorted(Path().rglob("*"))
        code, out, err = lmap(*arguments)
        assert (code, out) == (2, ""), err
        assert sorted(Path().rglob("*")) == before
        return err.splitlines()

    return run
