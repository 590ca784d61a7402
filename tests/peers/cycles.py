"""Renders a case of a mesh with Blender Cycles: blender -b --factory-startup -P cycles.py -- CASE.json OUT.exr SAMPLES [sharp]

Prints "ms" and the time of the second of two frames, with the scene loaded. "sharp": through a pinhole.
"""

import json
import math
import os
import sys
import time

import bpy
import numpy
from mathutils import Matrix

case_file, out, samples, *options = sys.argv[sys.argv.index("--") + 1:]
folder = os.path.dirname(case_file)
with open(case_file, encoding="utf-8") as file:
    case = json.load(file)
with open(os.path.join(folder, case["camera"][0]), encoding="utf-8") as file:
    transforms = json.load(file)
lens = case["lens"]

numpy.bool = bool  # Debian's reader of glTF is older than its numpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=next(os.path.join(folder, name) for name in case["scene"] if name.endswith(".glb")))
scene = bpy.context.scene
for material in bpy.data.materials:  # Blender interpolates codes of sRGB, not light: edges would be too dark
    for node in material.node_tree.nodes:
        if node.type == "TEX_IMAGE":
            node.interpolation = "Closest"

camera = bpy.data.cameras.new("camera")
camera.sensor_fit = "HORIZONTAL"
camera.sensor_width = 1000.0 * lens["sensor_width_m"]
camera.lens = 1000.0 * lens["focal_length_m"]
camera.clip_start = 0.01
camera.dof.use_dof = "sharp" not in options
camera.dof.focus_distance = lens["focus_m"]
camera.dof.aperture_fstop = lens["f_number"]
seen_from = bpy.data.objects.new("camera", camera)
# Blender's reader of glTF turns y up to z up.
y_up_to_z_up = Matrix.Rotation(math.pi / 2.0, 4, "X")
seen_from.matrix_world = y_up_to_z_up @ Matrix(transforms["frames"][0]["transform_matrix"])
scene.collection.objects.link(seen_from)
scene.camera = seen_from

scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*case["background_linear_rgb"], 1.0)

render = scene.render
render.engine = "CYCLES"
render.resolution_x, render.resolution_y = case["image_px"]
render.resolution_percentage = 100
render.use_persistent_data = True
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_mode = "RGB"
render.image_settings.color_depth = "32"
render.filepath = out
scene.cycles.samples = int(samples)
scene.cycles.use_adaptive_sampling = False
scene.cycles.use_denoising = False
scene.cycles.max_bounces = 0  # all colours are light that leaves the surface
# The case's pixel filter: close to a Gaussian of 1 px standard deviation, a quarter of Blender's width.
scene.cycles.pixel_filter_type = "GAUSSIAN"
scene.cycles.filter_width = 4.0

bpy.ops.render.render()
start = time.perf_counter()
bpy.ops.render.render(write_still=True)
print("ms", 1000.0 * (time.perf_counter() - start))
