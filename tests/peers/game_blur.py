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


def gathered(planes, radius_px, weight):
    """The sum over taps, spread evenly over each pixel's own disc (Vogel's spiral), of weight and weighted colour.

    planes: of the neighbours, the colour first; weight: of (distance, *planes), for each pixel that a tap stands for
    """
    rows, columns = np.indices(radius_px.shape, np.float32)
    total, light = np.zeros_like(radius_px), np.zeros_like(planes[0])
    for i in range(TAPS):
        distance = radius_px * np.float32(np.sqrt((i + 0.5) / TAPS))
        turn = i * np.pi * (3.0 - np.sqrt(5.0))
        x, y = columns + distance * np.float32(np.cos(turn)), rows + distance * np.float32(np.sin(turn))
        color, *others = (cv2.remap(plane, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE) for plane in planes)
        part = weight(distance, *others) * (np.pi * radius_px**2 / TAPS)
        total += part
        light += part[..., None] * color
    return total, light


def blurred(sharp, depth_m, lens):
    """The image through a lens.

    sharp: linear light through a pinhole; depth_m: 0 for the background; lens: of case.json
    """
    vergence = np.where(depth_m > 0, 1.0 / np.maximum(depth_m, 1e-6), 0.0).astype(np.float32)
    off_D = vergence - np.float32(1.0 / lens["focus_m"])
    radius = np.abs(off_D) * np.float32(lens["blur_radius_px_per_D"])
    near = (off_D > 0).astype(np.float32)
    share = 1.0 / np.maximum(np.pi * radius**2, 1.0)  # a disc spreads its light over its area, in pixels

    def covers(reach, distance):
        return np.clip(reach - distance + 0.5, 0.0, 1.0)

    def far_weight(distance, r, v, n, s):
        reach = np.where(v >= 0.98 * vergence, r, np.minimum(r, radius))
        return covers(reach, distance) * s * (1.0 - n)

    def near_weight(distance, r, _, n, s):
        return covers(r, distance) * s * n

    planes = (sharp, radius, vergence, near, share)
    side = 2 * int(np.ceil((near * radius).max())) + 1
    near_reach = cv2.dilate(near * radius, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side)))
    layers = [gathered(planes, radius, far_weight), gathered(planes, near_reach, near_weight)]
    colors, covered = [], []
    for (weight, light), own in zip(layers, (1.0 - near, near)):
        weight = weight + own * share  # the pixel itself always counts
        light = light + (own * share)[..., None] * sharp
        colors.append(light / np.maximum(weight, 1e-9)[..., None])
        covered.append(np.clip(weight, 0.0, 1.0)[..., None])
    cover = np.where(covered[0] < 1e-6, 1.0, covered[1])  # where the near layer hides all of the far one
    return (cover * colors[1] + (1.0 - cover) * colors[0]).astype(np.float32)
