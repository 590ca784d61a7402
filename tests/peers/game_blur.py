"""The blur of games: one gather over the sharp image and its depth, in two layers.

Nearer than the focus lies the near layer, the rest is the far layer. Each pixel gathers the
neighbours whose discs reach it. In the far layer, a neighbour behind the pixel spreads no farther
than the pixel's own disc, so that background does not leak over what is in focus. The near layer is
laid over the far one by the share of the pixel that its discs cover (Sousa, CryENGINE 3 Graphics
Gems, and Jimenez, Next Generation Post Processing in Call of Duty; SIGGRAPH courses 2013 and 2014).
"""

import cv2
import numpy as np

TAPS = 96  # of a gather


def spiral(radius_px):
    """Offsets evenly spread over a disc (Vogel's spiral)."""
    i = np.arange(TAPS) + 0.5
    r, turn = radius_px * np.sqrt(i / TAPS), i * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([r * np.cos(turn), r * np.sin(turn)], axis=1)


def neighbours(plane, offset):
    """The value at an offset from each pixel."""
    matrix = np.float32([[1, 0, -offset[0]], [0, 1, -offset[1]]])
    return cv2.warpAffine(plane, matrix, plane.shape[1::-1], flags=cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE)


def blurred(sharp, depth_m, lens):
    """The image through a lens.

    sharp: linear light through a pinhole; depth_m: 0 for the background; lens: of case.json
    """
    vergence = np.where(depth_m > 0, 1.0 / np.maximum(depth_m, 1e-6), 0.0).astype(np.float32)
    off_D = vergence - np.float32(1.0 / lens["focus_m"])
    radius = np.abs(off_D) * np.float32(lens["blur_radius_px_per_D"])
    layers = [(off_D <= 0).astype(np.float32), (off_D > 0).astype(np.float32)]  # far, near
    widest = max(float(radius.max()), 0.5)
    # A disc spreads its light over its area, in pixels; the pixel itself always counts.
    share = 1.0 / np.maximum(np.pi * radius**2, 1.0)
    weights = [layer * share for layer in layers]
    sums = [weight[..., None] * sharp for weight in weights]
    for offset in spiral(widest):
        color, r, v, near, s = (neighbours(plane, offset) for plane in (sharp, radius, vergence, layers[1], share))
        reach = np.where((near > 0) | (v >= 0.98 * vergence), r, np.minimum(r, radius))
        weight = np.clip(reach - np.float32(np.hypot(*offset)) + 0.5, 0.0, 1.0) * s * (np.pi * widest**2 / TAPS)
        for i, part in enumerate((weight * (1.0 - near), weight * near)):
            weights[i] += part
            sums[i] += part[..., None] * color
    far, front = (sums[i] / np.maximum(weights[i], 1e-9)[..., None] for i in range(2))
    cover = np.clip(weights[1], 0.0, 1.0)[..., None]
    empty = (weights[0] < 1e-6)[..., None]  # the far layer is hidden here
    return np.where(empty, front, cover * front + (1.0 - cover) * far).astype(np.float32)
