"""A figure: a scene at two distances of focus, and its defocus at both.

    python3 examples/python/figure.py SCENE DISTANCE_M OUT.png [UP]

The eye stands DISTANCE_M in front of the scene's middle, e.g. 0.3, and the scene is scaled to fill the screen. UP is
its upward axis: y (the default), z for most scans, -y for most captured scenes of Gaussians.
"""

import foci
import numpy as np

from view import number, run, view

SIZE_PX = (960, 540)


def main(path, distance, out, up="y"):
    import matplotlib

    matplotlib.use("Agg")  # needs no display
    import matplotlib.pyplot as plt

    screen = foci.Screen()
    scene, eye = view(path, number("DISTANCE_M", distance), up, screen)
    depth_m = foci.render(scene, eye, screen, size_px=SIZE_PX, method="pinhole").depth_m
    if not depth_m.any():
        raise foci.InputError(f"{path}: the eye sees no surface")
    # A near and a far part of the scene: a tenth of the surface is nearer, a tenth is farther.
    focuses_m = np.percentile(depth_m[depth_m > 0], (10, 90))
    images = [foci.render(scene, eye, screen, focus_m=focus_m, size_px=SIZE_PX, background=(0.2, 0.2, 0.2))
              for focus_m in focuses_m]
    limit_D = max(np.nanpercentile(np.abs([image.defocus_D for image in images]), 98), 0.01)

    figure, axes = plt.subplots(2, 2, figsize=(10, 5.6), layout="constrained")
    for (above, below), image, focus_m in zip(axes.T, images, focuses_m):
        above.imshow(image.srgb())
        above.set_title(f"focus at {focus_m:.2f} m")
        below.set_facecolor("0.6")  # no surface
        shown = below.imshow(image.defocus_D, cmap="coolwarm", vmin=-limit_D, vmax=limit_D)
        for axis in (above, below):
            axis.set_xticks([])
            axis.set_yticks([])
    axes[0, 0].set_ylabel("what the eye sees")
    axes[1, 0].set_ylabel("defocus")
    figure.colorbar(shown, ax=axes[1], extend="both", label="dioptres\nfarther < 0 < nearer")
    figure.savefig(out, dpi=120)


run(main, __doc__)
