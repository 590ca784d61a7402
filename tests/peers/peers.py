#!/usr/bin/env python3
"""Renders exported cases with other renderers, and lists the images in times.json.

    foci chart --quick --scene ball --scene gallery --export out/cases
    python3 tests/peers/peers.py out/cases
    foci chart --quick --scene ball --scene gallery --import out/cases --out out/peers

The blur of games (game_blur.py) renders every case, Blender Cycles those of a mesh; Spark and PlayCanvas those of
Gaussians, in Chromium. These two are looked for in the folder of --npm:

    npm install --prefix out/npm @sparkjsdev/spark three playcanvas

A renderer that is not installed is skipped, with a line.
"""

import argparse
import glob
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import time

import in_browser

HERE = os.path.dirname(os.path.abspath(__file__))


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        model = re.search(r"model name\s*: (.*)", file.read())
    return f"{model[1] if model else 'unknown CPU'}, {os.cpu_count()} threads"


class Peers:
    def __init__(self, folder):
        self.folder = folder
        self.images = []
        self.cases = []
        for name in sorted(glob.glob(os.path.join(folder, "*", "*", "case.json"))):
            with open(name, encoding="utf-8") as file:
                self.cases.append((os.path.dirname(os.path.relpath(name, folder)), json.load(file)))

    def add(self, renderer, version, case, ms, image, sharp):
        self.images.append({"name": renderer, "version": version, "machine": machine(), "ms": ms, "case": case["case"],
                            "image": image, "sharp": sharp})
        print(f"{case['case']}: {renderer}, {ms:.0f} ms", file=sys.stderr)

    def game_blur(self):
        os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
        try:
            import cv2
        except ImportError:
            print("the blur of games is skipped: Python has no OpenCV (python3-opencv)", file=sys.stderr)
            return
        sys.path.insert(0, HERE)
        import game_blur

        def plane(*name):
            return cv2.imread(os.path.join(self.folder, *name), cv2.IMREAD_UNCHANGED)

        for name, case in self.cases:
            scene = os.path.dirname(name)
            sharp, depth_m = plane(scene, "sharp.exr"), plane(scene, "depth.exr")
            start = time.perf_counter()
            image = game_blur.blurred(sharp, depth_m, case["lens"])
            ms = 1000.0 * (time.perf_counter() - start)
            cv2.imwrite(os.path.join(self.folder, name, "game_blur.exr"), image)
            self.add("game-blur", f"OpenCV {cv2.__version__}", case, ms, f"{name}/game_blur.exr", f"{scene}/sharp.exr")

    def write(self):
        """Puts the images into times.json, beside those of other renderers."""
        name = os.path.join(self.folder, "times.json")
        ours = {(image["name"], image["case"]) for image in self.images}
        others = []
        if os.path.exists(name):
            with open(name, encoding="utf-8") as file:
                others = [one for one in json.load(file) if (one["name"], one["case"]) not in ours]
        with open(name + ".part", "w", encoding="utf-8") as file:
            json.dump(others + self.images, file, indent=1)
        os.replace(name + ".part", name)

    def cycles(self, samples):
        blender = shutil.which("blender")
        if blender is None:
            print("Blender Cycles is skipped: blender is not installed", file=sys.stderr)
            return
        version = subprocess.run([blender, "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout
        version = version.splitlines()[0]

        def rendered(case_name, image, samples, *options):
            out = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "-P", os.path.join(HERE, "cycles.py"), "--",
                                  os.path.join(self.folder, case_name, "case.json"),
                                  os.path.abspath(os.path.join(self.folder, image)), str(samples), *options],
                                 check=True, stdout=subprocess.PIPE, text=True).stdout
            return float(re.search(r"^ms (.*)$", out, re.M)[1])

        for name, case in self.cases:
            if not any(file.endswith(".glb") for file in case["scene"]):
                continue
            sharp = f"{os.path.dirname(name)}/cycles_sharp.exr"
            if all(image["sharp"] != sharp for image in self.images):
                rendered(name, sharp, 64, "sharp")
            for count in samples:
                image = f"{name}/cycles_{count}.exr"
                self.add(f"Cycles:{count}", version, case, rendered(name, image, count), image, sharp)

    def viewer(self, name, package, needs, npm, shares):
        """Renders the cases of Gaussians by a page of that name.

        shares: suffix of the name -> share of the aperture that the viewer is told; none: it has no lens, and its
        sharp image counts
        """
        modules = os.path.join(npm, "node_modules")
        missing = [one for one in (package, *needs) if not os.path.exists(os.path.join(modules, one, "package.json"))]
        missing += [] if in_browser.installed() else ["chromium"]
        if missing:
            print(f"{name} is skipped: {', '.join(missing)} not installed (--npm)", file=sys.stderr)
            return
        with open(os.path.join(modules, package, "package.json"), encoding="utf-8") as file:
            version = f"{json.load(file)['version']} on SwiftShader"
        page = name.lower()
        for scene, cases in itertools.groupby(self.cases, lambda case: os.path.dirname(case[0])):
            cases = list(cases)
            first = cases[0][1]
            if first["scene"] != ["../gaussians.ply"]:  # of surfels it is an approximation
                continue
            with open(os.path.join(self.folder, scene, "transforms.json"), encoding="utf-8") as file:
                camera = json.load(file)
            sharp = f"{scene}/{page}_sharp.png"
            pictures, wanted = [{"file": sharp}], []
            for case_name, case in cases:
                wanted += [] if shares else [(name, case, sharp)]
                for suffix, share in shares.items():
                    image = f"{case_name}/{page}{suffix.replace(':', '_')}.png"
                    pictures.append({"file": image, "focus_m": case["lens"]["focus_m"],
                                     "aperture_m": share * case["lens"]["aperture_m"]})
                    wanted.append((name + suffix, case, image))
            ms = in_browser.milliseconds(os.path.join(HERE, f"{page}.html"), self.folder, modules, {
                "gaussians": f"/cases/{scene}/gaussians.ply", "image_px": first["image_px"],
                "background_linear_rgb": first["background_linear_rgb"], "fov_y_rad": camera["camera_angle_y"],
                "world_from_camera": camera["frames"][0]["transform_matrix"], "pictures": pictures})
            for renderer, case, image in wanted:
                self.add(renderer, version, case, ms[image], image, sharp)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", help="folder that foci chart --export wrote")
    parser.add_argument("--npm", default=os.path.join("out", "npm"), help="folder of npm install --prefix (%(default)s)")
    parser.add_argument("--samples", type=int, nargs="+", default=[16, 64, 256], help="of Cycles, a pixel")
    args = parser.parse_args()
    peers = Peers(args.cases)
    try:
        peers.game_blur()
        peers.cycles(args.samples)
        # Spark's blur is a Gaussian whose standard deviation is the disc's radius; half of it has the disc's variance.
        peers.viewer("Spark", "@sparkjsdev/spark", ["three"], args.npm, {"": 1.0, ":half-aperture": 0.5})
        peers.viewer("PlayCanvas", "playcanvas", [], args.npm, {})
    finally:
        peers.write()


if __name__ == "__main__":
    main()
