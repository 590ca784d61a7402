"""`python -m foci`: the command `foci`, which a wheel holds; with --version also where there is none."""

import os
import pathlib
import shutil
import sys

from . import __version__


def main():
    beside = pathlib.Path(__file__).with_name("foci")
    command = str(beside) if beside.exists() else shutil.which("foci")
    if command:
        os.execv(command, ["foci", *sys.argv[1:]])
    if sys.argv[1:] == ["--version"]:
        print(f"foci {__version__}")
        return
    sys.exit("foci: the command foci is not installed, only the module: install the package or the wheel foci")


if __name__ == "__main__":
    main()
