#!/usr/bin/env python3
"""Attacks on the real program: nothing lost, nothing silent, nobody let in.

    attacks.py FOCI [--only TEXT] [--list] [--jobs N] [--keep]

Each case runs `foci` in a box, a new folder with small inputs, and counts as a fault if foci
  overwrites  a file that was there before is changed or gone, or one appears that should not,
  is silent   it fails without a line, or says not what it should,
  executes    a file named TOUCHED appears (hostile names try to run `touch TOUCHED`),
  crashes     a signal ends it,
  hangs       it takes over 10 s (more on a busy machine),
  memory      it takes over 2 GiB.
The goal is 0. The exit code is 1 if there is a fault.

To add cases, write a function in tests/attacks/cases_*.py (each such file is loaded):

    from box import attack

    @attack(*["a.tsv", "b.tsv"])        # one case for each value; a tuple is spread over the arguments
    def my_kind(box, name):
        box.write(name, "time_s\\tx_px\\ty_px\\n")
        box.run("events", name).refused("expected at least 2")

`box.run(...)` gives an outcome: `.done()` wants exit code 0, `.refused(text)` exit code 2 and one line with the text,
`.failed(text)` exit code 1 and one line with the text, `.any()` 0 or one of these. `box.may_change(name)` allows a file
to change. `box.live(...)` starts foci under a virtual display. box.py has the rest. Cases are deterministic: random
ones take `box.random`, seeded with the case's name.
"""

import argparse
import concurrent.futures
import importlib
import pathlib
import signal
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import box  # noqa: E402


def main():
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job, and its children, ignore it
    parser = argparse.ArgumentParser(description="attacks on foci; goal: 0 faults")
    parser.add_argument("foci", type=pathlib.Path)
    parser.add_argument("--only", default="", help="cases whose name has this text")
    parser.add_argument("--list", action="store_true", help="print the names of the cases")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", action="store_true", help="keep the boxes of faults")
    options = parser.parse_args()
    for module in sorted(pathlib.Path(__file__).parent.glob("cases_*.py")):
        importlib.import_module(module.stem)
    cases = [case for case in box.CASES if options.only in case.name]
    if options.list:
        print("\n".join(case.name for case in cases))
        return 0
    start = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda case: case.run(options.foci.resolve(), options.keep), cases))
    faults = [result for result in results if result.kind not in ("", "skipped")]
    for result in results:
        if result.kind:
            print(f"{result.kind:<10} {result.name}: {result.what}")
    skipped = sum(result.kind == "skipped" for result in results)
    print(f"{len(cases)} attacks, {len(faults)} faults, {skipped} skipped; {time.monotonic() - start:.0f} s")
    if not cases:
        print("no case has this name")
    return 1 if faults or not cases else 0


if __name__ == "__main__":
    sys.exit(main())
