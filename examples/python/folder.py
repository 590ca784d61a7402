"""Fixations of every recording in a folder and its subfolders, one table over all.

    python3 examples/python/folder.py FOLDER OUT.tsv

Each cell below can be pasted into a notebook. A file that foci cannot read is named and left out.
"""

# %% The recordings
import pathlib
import sys

import foci
import numpy as np

if len(sys.argv) != 3:
    sys.exit("usage: python3 examples/python/folder.py FOLDER OUT.tsv")
folder, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
for needed in (folder, out.parent):
    if not needed.is_dir():
        sys.exit(f"{needed}: is not a folder")
if out.is_dir():
    sys.exit(f"{out}: is a folder; expected a file")

recordings = {}
for file in sorted(path for path in folder.rglob("*") if path.is_file()):
    try:
        recordings[file.relative_to(folder)] = foci.Recording.open(file)
    except foci.InputError as error:
        print(f"left out: {error}", file=sys.stderr)
if not recordings:
    sys.exit(f"{folder}: no recording that foci reads")

# %% One row for each recording
rows = []
for name, recording in recordings.items():
    events = recording.events()
    fixations = events[events["event"] == "fixation"]
    saccades = events[events["event"] == "saccade"]
    rows.append((name, len(recording), recording.rate_Hz, len(fixations),
                 1000 * np.median(fixations["duration_s"]) if fixations.size else np.nan,
                 np.median(saccades["amplitude_deg"]) if saccades.size else np.nan))

# %% The table
with open(out, "w") as table:
    print("recording", "samples", "rate_Hz", "fixations", "median_fixation_ms", "median_saccade_deg", sep="\t",
          file=table)
    for name, samples, rate_Hz, count, fixation_ms, saccade_deg in rows:
        print(name, samples, f"{rate_Hz:.0f}", count, f"{fixation_ms:.0f}", f"{saccade_deg:.2f}", sep="\t", file=table)
print(f"recordings: {len(rows)}; table: {out}")
