"""Makes a wheel of the module and of the command `foci`, with the shared libraries that they need.

    cmake --preset wheel && cmake --build --preset wheel --target foci foci_python
    python3 python/wheel.py [FOLDER]       # build/wheel is the default

With -DFOCI_PYTHON_HEADERS=... it is a wheel for several Pythons (CONTRIBUTING.md). It needs the packages patchelf and
binutils. The libraries are Debian's and find their neighbours by $ORIGIN. The wheel states their licences.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
# Part of every Linux of that glibc (PEP 600).
OF_THE_SYSTEM = re.compile(r"(ld-linux-x86-64|lib(c|m|dl|rt|pthread|util|resolv|stdc\+\+|gcc_s|z))\.so\.\d+")


def output(*command):
    if not shutil.which(command[0]):
        sys.exit(f"{command[0]} is not there: apt-get install patchelf binutils")
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout


def needed(file):
    return [name for name in output("patchelf", "--print-needed", file).split() if not OF_THE_SYSTEM.fullmatch(name)]


def libraries_of(programs):
    """Path by name, of all that the programs need."""
    places = dict(re.findall(r"^\s*(\S+) .*x86-64.* => (\S+)", output("/sbin/ldconfig", "-p"), re.M)[::-1])
    found, todo = {}, [name for program in programs for name in needed(program)]
    while todo:
        name = todo.pop()
        if name not in found:
            found[name] = pathlib.Path(places[name]).resolve()
            todo += needed(found[name])
    return found


def package_of(library):
    """Debian's package of a file, which may be listed below / or below /usr."""
    for place in (library, str(library).removeprefix("/usr")):
        listed = subprocess.run(["dpkg", "-S", place], capture_output=True, text=True).stdout
        if listed:
            return listed.split(":")[0]
    sys.exit(f"{library}: of no package, so that its licence is not known")


def stage(build, tree):
    package = tree / "foci"
    shutil.copytree(build / "python" / "foci", package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(build / "foci", package / "foci")
    programs = [package / "foci", *package.glob("_foci.*.so")]
    libraries = libraries_of(programs)
    folder = tree / "foci.libs"
    folder.mkdir()
    for name, path in libraries.items():
        shutil.copy(path, folder / name)
        (folder / name).chmod(0o755)
    for file in [*folder.iterdir(), *programs]:
        place = "$ORIGIN" if file.parent == folder else "$ORIGIN/../foci.libs"
        output("patchelf", "--force-rpath", "--set-rpath", place, file)
    return sorted({package_of(path) for path in libraries.values()})


def describe(tree, version, platform, packages, pythons):
    info = tree / f"foci-{version}.dist-info"
    licences = info / "licenses"
    licences.mkdir(parents=True)
    shutil.copy(ROOT / "LICENSE", licences / "LICENSE")
    for package in packages:
        shutil.copy(f"/usr/share/doc/{package}/copyright", licences / f"{package}.copyright")
    # The pybind11 of Debian 12 does not know NumPy 2; the one that comes with the headers of further Pythons does.
    numpy = "numpy" if len(pythons) > 1 else "numpy<2"
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: foci\nVersion: {version}\n"
        "Summary: See a scene as a human eye would focus it, following where the observer looks\n"
        + "".join(f"License-File: licenses/{file.name}\n" for file in sorted(licences.iterdir()))
        + f"Requires-Python: >=3.{min(pythons)}\nRequires-Dist: {numpy}\n\n"
        "The wheel holds shared libraries of Debian. Their licences stand in the folder licenses; those of SuiteSparse are\n"
        "LGPL and GPL, which then hold for the wheel as a whole.\n")
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: foci\nRoot-Is-Purelib: false\n"
                                + "".join(f"Tag: cp3{p}-cp3{p}-{platform}\n" for p in pythons))
    (info / "entry_points.txt").write_text("[console_scripts]\nfoci = foci.__main__:main\n")
    return info


def pack(tree, info, wheel):
    """Equal files give equal bytes."""
    record = info / "RECORD"
    rows = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        def add(file, content):
            entry = zipfile.ZipInfo(str(file.relative_to(tree)), (2000, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100755 if os.access(file, os.X_OK) else 0o100644) << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
        for file in sorted(path for path in tree.rglob("*") if path.is_file()):
            content = file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            rows.append(f"{file.relative_to(tree)},sha256={digest},{len(content)}\n")
            add(file, content)
        add(record, "".join(rows) + f"{record.relative_to(tree)},,\n")


def main():
    build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "wheel").resolve()
    version = re.search(r"project\(foci VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    modules = (build / "python" / "foci").glob("_foci.cpython-3*.so")
    pythons = sorted(int(re.match(r"_foci\.cpython-3(\d+)", module.name).group(1)) for module in modules)
    tags = ".".join(f"cp3{minor}" for minor in pythons)
    platform = f"manylinux_{glibc}_x86_64"
    with tempfile.TemporaryDirectory() as temporary:
        tree = pathlib.Path(temporary)
        packages = stage(build, tree)
        wheel = build / f"foci-{version}-{tags}-{tags}-{platform}.whl"
        pack(tree, describe(tree, version, platform, packages, pythons), wheel)
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB, with libraries of {len(packages)} packages")


main()
