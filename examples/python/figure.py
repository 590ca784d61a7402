"""A figure: a scene at two distances of focus, and its defocus.

    python3 examples/python/figure.py SCENE.ply DISTANCE_M OUT.png

The scene is scaled to a height of half a metre. The eye stands DISTANCE_M in front of its middle, e.g. 0.8.
"""

import sys

import foci
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

path, distance_m, out = sys.argv[1], float(sys.argv[2]), sys.argv[3]
low, high = foci.Scene.open(path).bounds_m
scene = foci.Scene.open(path, scale_m=0.5 / (high[1] - low[1]))
low, high = scene.bounds_m
middle = [(a + b) / 2 for a, b in zip(low, high)]
eye = foci.Eye(pupil_mm=6, position_m=(middle[0], middle[1], middle[2] + distance_m), look_at_m=middle)

figure, axes = plt.subplots(1, 3, figsize=(12, 2.8), layout="constrained")
for axis, focus_m in zip(axes, (distance_m, 2 * distance_m)):
    image = foci.render(scene, eye, focus_m=focus_m, size_px=(640, 360), background=(0.2, 0.2, 0.2))
    axis.imshow(image.srgb())
    axis.set_title(f"focus at {focus_m:g} m")
shown = axes[2].imshow(image.defocus_D, cmap="coolwarm", vmin=-1, vmax=1)  # 0: in focus
axes[2].set_title("defocus of the second")
figure.colorbar(shown, ax=axes[2], label="dioptres")
for axis in axes:
    axis.set_axis_off()
figure.savefig(out, dpi=120)
