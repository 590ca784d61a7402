"""Installs foci to an empty folder, then builds and runs the programs of examples/ against that copy.

    examples_test.py CMAKE BUILD_FOLDER CXX

It also compiles the installed headers. A header may include the standard library, GLM and other installed headers.
"""

import math
import pathlib
import re
import subprocess
import sys
import tempfile

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
MAX_LINES = 40


def run(*command, **options):
    """Standard output of a command that must succeed."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nexited with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def expect(condition, message):
    if not condition:
        sys.exit(message)


def refused(*command, says, **options):
    """A command that must fail, and say this."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    expect(done.returncode != 0 and says in done.stderr and not done.stdout.startswith("model"),
           f"{' '.join(map(str, command))}\nexited with {done.returncode}:\n{done.stdout}{done.stderr}")


def check_components(cmake, prefix, cxx, folder):
    """find_package takes the components by the names of the targets, and says which one it does not know."""
    folder.mkdir()
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(components LANGUAGES CXX)\n"
        "find_package(foci REQUIRED COMPONENTS ${asked})\n")
    configure = [cmake, "-S", folder, "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
                 f"-DCMAKE_CXX_COMPILER={cxx}"]
    run(*configure, "-Dasked=base;render;literature;gaze;calibration;eye")
    refused(*configure, "-Dasked=render;sound", says="unknown component sound: expected one of base, render, literature, gaze")


def check_subproject(cmake, cxx, folder):
    """A project that adds foci gets its targets without the program's packages, and none of its flags."""
    folder.mkdir()
    (folder / "main.cpp").write_text("#include <foci/app/session/session.h>\nint main() { return foci::methods().empty(); }\n")
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(embeds LANGUAGES CXX)\n"
        f'add_subdirectory("{EXAMPLES.parent}" foci EXCLUDE_FROM_ALL)\n'
        "add_executable(embeds main.cpp)\ntarget_link_libraries(embeds PRIVATE foci::eye)\n")
    absent = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON" for package in ("glfw3", "CLI11", "GTest", "benchmark")]
    run(cmake, "-S", folder, "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={cxx}", *absent)
    run("ninja", "-C", folder / "build", "CMakeFiles/embeds.dir/main.cpp.o", "foci/libfoci_base.a")
    libraries = run("ninja", "-C", folder / "build", "-t", "commands", "embeds")
    for absent in ("libzmq", "libglfw", "imgui", "-Werror"):
        expect(absent not in libraries, f"a project that adds foci gets {absent}")


def check_render_alone(cmake, cxx, folder):
    """Where only TBB, GLM, Highway, nanoflann, nlohmann's JSON, libpng and OpenGL are installed, foci::render can be used."""
    folder.mkdir()
    (folder / "main.cpp").write_text("#include <foci/render/methods/method.h>\nint main() { return foci::methods().empty(); }\n")
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(embeds LANGUAGES CXX)\n"
        f'add_subdirectory("{EXAMPLES.parent}" foci EXCLUDE_FROM_ALL)\n'
        "add_executable(embeds main.cpp)\ntarget_link_libraries(embeds PRIVATE foci::render)\n")
    absent = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON"
              for package in ("OpenCV", "Ceres", "toml11", "embree", "draco", "meshoptimizer", "assimp")]
    run(cmake, "-S", folder, "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={cxx}", *absent)
    sources = ("CMakeFiles/foci_base.dir/base/image_codec.cpp.o", "render/CMakeFiles/foci_render.dir/scene/io/compression.cpp.o",
               "render/CMakeFiles/foci_render.dir/scene/io/mesh_files.cpp.o")
    run("ninja", "-C", folder / "build", "CMakeFiles/embeds.dir/main.cpp.o", *(f"foci/{source}" for source in sources))
    commands = run("ninja", "-C", folder / "build", "-t", "commands", "embeds")
    expect("-o embeds" in commands and "libpng" in commands, commands)
    for absent in ("opencv", "ceres", "embree", "draco", "turbojpeg", "webp", "zstd"):
        expect(absent not in commands, f"foci::render alone needs {absent}")


def check_headers(include, cxx):
    headers = sorted(include.rglob("*.h"))
    expect(len(headers) > 50, f"only {len(headers)} headers in {include}")
    for header in headers:
        for bracket, name in re.findall(r'^\s*#\s*include\s*([<"])([^>"]+)', header.read_text(), re.M):
            if bracket == '"':
                expect((include / name).exists(), f"{header}: {name} is not installed")
            else:
                expect(re.fullmatch(r"[a-z_]+|cstd\w+|glm/.*", name), f"{header}: <{name}> is neither standard nor GLM")

    # Together, which takes seconds: one that leans on the header before it is not found here.
    everything = "".join(f'#include "{header.relative_to(include)}"\n' for header in headers)
    run(cxx, "-std=c++20", "-fsyntax-only", "-Wall", "-Werror", "-x", "c++", f"-I{include}", "-", input=everything)


def write_inputs(folder):
    """A square of points, half a second at each of two places, and nine targets measured 1 degree to their right."""
    points = [(x / 20 - 0.5, y / 20 - 0.5) for x in range(21) for y in range(21)]
    rows = "".join(f"{x} {y} 0 200 120 40\n" for x, y in points)
    (folder / "square.ply").write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
        + "".join(f"property float {axis}\n" for axis in "xyz")
        + "".join(f"property uchar {colour}\n" for colour in ("red", "green", "blue")) + "end_header\n" + rows)
    (folder / "recording.tsv").write_text("time_s\tx_px\ty_px\n" + "".join(
        f"{i / 250:.3f}\t{(600 if i < 125 else 1300) + math.sin(i)}\t540\n" for i in range(250)))
    (folder / "pairs.tsv").write_text("x\ty\tx_target\ty_target\n" + "".join(
        f"{x + 1.0 + 0.05 * math.sin(i)}\t{y + 0.05 * math.cos(i)}\t{x}\t{y}\n"
        for x in (-8, 0, 8) for y in (-5, 0, 5) for i in range(20)))


def main():
    cmake, build, cxx = sys.argv[1:]
    for source in EXAMPLES.glob("*.cpp"):
        lines = len(source.read_text().splitlines())
        expect(lines <= MAX_LINES, f"{source.name} has {lines} lines; at most {MAX_LINES} are allowed")

    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        prefix, programs = folder / "prefix", folder / "build"
        run(cmake, "--install", build, "--prefix", prefix)
        check_headers(prefix / "include" / "foci", cxx)
        expect((prefix / "bin" / "foci").exists(), "the program is not installed")

        run(cmake, "-S", EXAMPLES, "-B", programs, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
            f"-DCMAKE_CXX_COMPILER={cxx}")
        run(cmake, "--build", programs)
        expect("-Werror" not in (programs / "build.ninja").read_text(), "the flags of foci leak to its users")

        check_components(cmake, prefix, cxx, folder / "components")
        check_subproject(cmake, cxx, folder / "subproject")
        check_render_alone(cmake, cxx, folder / "alone")
        write_inputs(folder)
        out = run(programs / "render_ply", "square.ply", "2", "square.png", cwd=folder)
        expect("441 surfels" in out and (folder / "square.png").read_bytes().startswith(b"\x89PNG"), out)
        for focus in ("0", "-1", "near", "2m"):
            refused(programs / "render_ply", "square.ply", focus, "no.png", says=f"FOCUS_METRES {focus}: ", cwd=folder)
        expect(not (folder / "no.png").exists(), "an image for a focus that is none")
        out = run(programs / "own_method", "square.ply", "grey.png", cwd=folder)
        expect(out.split() == ["auto", "sweep", "sweep-lod", "accumulate", "pinhole", "grey"], out)
        expect((folder / "grey.png").exists(), "no image by the method of one's own")
        out = run(programs / "detect_fixations", "recording.tsv", cwd=folder).splitlines()
        expect(len(out) == 3 and abs(float(out[2].split("\t")[2]) - 1300) < 5, f"not two fixations: {out}")
        out = run(programs / "fit_gaze_map", "pairs.tsv", "map.toml", cwd=folder)
        expect(re.search(r"straight ahead: -(1\.0|0\.9)", out) and (folder / "map.toml").exists(), out)
        refused(programs / "fit_gaze_map", "pairs.tsv", "none/map.toml", says="cannot write none/map.toml", cwd=folder)
        (folder / "frames").mkdir()
        run(programs / "replay_recording", "square.ply", "recording.tsv", "frames", cwd=folder)
        frames = list((folder / "frames").iterdir())
        expect(len(frames) == 10 and all(frame.read_bytes().startswith(b"PF") for frame in frames), f"frames: {frames}")
    print("The examples link and run, and the installed headers stand alone.")


main()
