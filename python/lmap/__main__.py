"""`python -m lmap` is `lmap`."""

from lmap.cli.app import main

main()
