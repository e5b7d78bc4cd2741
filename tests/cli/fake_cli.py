"""`lmap` on the stand-in core, as a process of its own: `python fake_cli.py [--slow SECONDS] ARGS...`."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "unit"))

import fake_railsim

sys.modules["lmap._railsim"] = fake_railsim

if sys.argv[1:2] == ["--slow"]:
    fake_railsim.SLOW = float(sys.argv[2])
    del sys.argv[1:3]

from lmap.cli.app import main  # noqa: E402

main()
