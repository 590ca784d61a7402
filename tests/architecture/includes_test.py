"""Holds every include of our own headers against the graph in docs/architecture.md.

    includes_test.py [ROOT]

The graph is the block that opens with "```includes". Each line, `folder -> folder folder ...`, says which folders a
folder may include, besides itself and base/. A folder may also include whatever those folders may include. The test
prints each offending line as file:line. It first checks itself on a small tree that breaks each rule once.
"""

import pathlib
import re
import sys
import tempfile

ROOMS = ("base", "render", "gaze", "calibration", "app", "python")
SOURCES = (".h", ".cpp", ".inc")
MAX_FILES_AT_THE_ROOT_OF_APP = 3
OURS = re.compile(r'\s*#\s*include\s*"([^"]+)"')
POSIX = ("dlfcn.h", "fcntl.h", "unistd.h", "sys/mman.h", "sys/resource.h", "sys/stat.h")  # files, memory, libraries
CODECS = ("png.h", "zlib.h", "turbojpeg.h", "webp/decode.h")  # in base/image_codec.cpp and gunzip.cpp
# Calls of the operating system; docs/platforms.md lists them.
PLATFORM = ("base", "app/platform")
SYSTEM = re.compile(r"(arpa/inet|csignal|dirent|dlfcn|fcntl|glob|net(db|inet/in)|poll|pwd|sched|signal|spawn|sys/\w+|"
                    r"termios|unistd)(\.h)?")
OTHERS = re.compile(r"\s*#\s*include\s*<([^>]+)>")


class BadGraph(Exception):
    """The graph itself cannot be used."""


def read_graph(page):
    """Folder -> the folders that its line names."""
    block = re.search(r"^```includes\n(.*?)^```", page, re.S | re.M)
    if not block:
        raise BadGraph("docs/architecture.md has no block that opens with ```includes")
    graph = {"base": []}
    for line in block.group(1).splitlines():
        if not line.strip():
            continue
        folder, arrow, targets = line.partition("->")
        if not arrow:
            raise BadGraph(f'docs/architecture.md: "{line}" is not "folder -> folder ..."')
        if folder.strip() in graph:
            raise BadGraph(f"docs/architecture.md: {folder.strip()} has two lines (base needs none)")
        graph[folder.strip()] = targets.split()
    for folder, targets in graph.items():
        for target in targets:
            if target not in graph:
                raise BadGraph(f"docs/architecture.md: {folder} -> {target}, but {target} has no line of its own")
    return graph


def reachable(graph):
    """Folder -> every folder that it may include, by its own line or by the lines of those it may include."""
    allowed = {}

    def visit(folder, path):
        if folder in path:
            circle = path[path.index(folder):] + [folder]
            raise BadGraph("docs/architecture.md: the graph has a circle: " + " -> ".join(circle))
        if folder not in allowed:
            found = {folder, "base"}
            for target in graph[folder]:
                found |= visit(target, path + [folder])
            allowed[folder] = found
        return allowed[folder]

    for folder in graph:
        visit(folder, [])
    return allowed


def violations(root):
    """One line of text for each rule that the tree below root breaks."""
    try:
        graph = read_graph((root / "docs" / "architecture.md").read_text())
        allowed = reachable(graph)
    except BadGraph as error:
        return [str(error)]

    files = sorted(f for room in ROOMS for f in (root / room).rglob("*") if f.suffix in SOURCES)
    folder_of = {f: f.parent.relative_to(root).as_posix() for f in files}
    folders = set(folder_of.values())
    found = [f"docs/architecture.md: {folder}/ has sources, but the graph has no line for it"
             for folder in sorted(folders - set(graph))]
    found += [f"docs/architecture.md: {folder} has a line, but there are no sources in {folder}/"
              for folder in sorted(set(graph) - folders)]

    at_root = [f.name for f in files if folder_of[f] == "app"]
    if len(at_root) > MAX_FILES_AT_THE_ROOT_OF_APP:
        found.append(f"app/ has {len(at_root)} source files at its root, but at most {MAX_FILES_AT_THE_ROOT_OF_APP} "
                     f"are allowed: {', '.join(at_root)}")

    for file in files:
        folder = folder_of[file]
        for number, line in enumerate(file.read_text().splitlines(), 1):
            where = f"{file.relative_to(root).as_posix()}:{number}"
            if own := OURS.match(line):
                target = own.group(1).rpartition("/")[0]
                if target.split("/")[0] not in ROOMS:
                    found.append(f'{where}: "{own.group(1)}" is not written from the root of the project')
                elif folder in allowed and target not in allowed[folder]:
                    may = " ".join(["base"] + graph[folder])
                    found.append(f"{where}: {folder} includes {target}, which is not allowed; allowed: {may}, "
                                 "and the folders that these may include")
            elif (other := OTHERS.match(line)) and SYSTEM.fullmatch(other.group(1)) and folder not in PLATFORM:
                found.append(f"{where}: <{other.group(1)}> is included outside {' and '.join(PLATFORM)}")
            elif folder == "base" and (other := OTHERS.match(line)):
                header = other.group(1)
                codec = header in CODECS and str(where).startswith(("base/image_codec.cpp", "base/gunzip.cpp"))
                if not (header.startswith("tbb/") or header in POSIX or codec or re.fullmatch(r"[a-z_]+", header)):
                    found.append(f"{where}: base includes <{header}>; allowed: the standard library, POSIX files and memory, "
                                 "TBB, and codecs in image_codec.cpp and gunzip.cpp")
    return found


def check_itself():
    """A made-up tree that breaks each rule once; every breach must be reported, and nothing else."""
    page = "# Rooms\n\n```includes\n{}\n```\n"
    sources = {
        "base/text.h": "#include <string>\n#include <tbb/task.h>\n#include <unistd.h>\n",
        "render/optics/eye.h": '#include "base/text.h"\n',
        "render/methods/sweep.cpp": '#include "render/image/frame.h"\n#include "render/optics/eye.h"\n',
        "render/image/frame.h": '#include "render/optics/eye.h"\n',
    }
    lines = ["render/optics ->", "render/image -> render/optics", "render/methods -> render/image"]

    def reported(more_sources=(), graph=None):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in {**sources, **dict(more_sources),
                               "docs/architecture.md": page.format("\n".join(graph or lines))}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            return violations(root)

    def expect(wanted, **tree):
        got = reported(**tree)
        if len(got) != len(wanted) or not all(w in g for w, g in zip(wanted, got)):
            sys.exit(f"The check of this test itself fails.\nExpected: {wanted}\nReported: {got}")

    expect([])
    expect(["render/optics/eye.h:2: render/optics includes render/image, which is not allowed; allowed: base"],
           more_sources={"render/optics/eye.h": '\n#include "render/image/frame.h"\n'})
    expect(["the graph has a circle: render/optics -> render/methods -> render/image -> render/optics"],
           graph=["render/optics -> render/methods"] + lines[1:])
    expect(["gaze/webcam/ has sources"], more_sources={"gaze/webcam/iris.cpp": ""})
    expect(["there are no sources in gaze/webcam/"], graph=lines + ["gaze/webcam ->"])
    expect(["gaze/webcam has no line of its own"], graph=lines[1:] + ["render/optics -> gaze/webcam"])
    expect(["base/text.h:1: base includes <toml.hpp>"], more_sources={"base/text.h": "#include <toml.hpp>\n"})
    expect(['"eye.h" is not written from the root'], more_sources={"render/optics/eye.cpp": '#include "eye.h"\n'})
    expect(["app/ has 4 source files at its root"],
           more_sources={f"app/{n}.cpp": "" for n in "abcd"}, graph=lines + ["app ->"])


def main():
    check_itself()
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
    if len(sys.argv) < 2:
        root = root.parents[2]
    found = violations(root)
    for line in found:
        print(line)
    if found:
        sys.exit(f"{len(found)} breaches of the graph in docs/architecture.md")
    print("Every include follows the graph in docs/architecture.md.")


main()
