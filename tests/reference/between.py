# SPDX-License-Identifier: GPL-3.0-or-later
"""Where chains of mesh edges pass between pixels: each edge is straight, and crosses rows and columns of centres."""

import numpy as np

MARK = 32  # a bit of a point's kind: drawn by hand
BOUNDS = 1 | 2 | 4 | 16 | 512  # contour, border, number, meet, material


def passages(points, shape, start):
    """[(row, column, axis, share, point)] in the order of the chains; axis 0: on the way from a pixel to its right
    neighbour, 1: to the lower one. start: (row, column) of the images in the full frame."""
    found = []
    for a, b in zip(points[:-1], points[1:], strict=True):
        if a["run"] != b["run"]:
            continue
        one, two = (np.array([p["y"], p["x"]], float) - start for p in (a, b))
        for across in (1, 0):  # columns of centres, on ways down, then rows
            low, high = sorted((one[across], two[across]))
            for line in range(max(0, int(np.ceil(low))), shape[across]):
                if line >= high:
                    break
                t = (line - one[across]) / (two[across] - one[across])
                at = one[1 - across] + t * (two[1 - across] - one[1 - across])
                pixel = int(np.floor(at))
                if 0 <= pixel < shape[1 - across] - 1:
                    row, column = (pixel, line) if across else (line, pixel)
                    depth = 1 / ((1 - t) / float(a["depth"]) + t / float(b["depth"]))
                    found.append((row, column, across, max(at - pixel, 1 / 1024), b, depth))
    return found


def marked(found, shape):
    """1 at the pixel whose centre is nearer to a line that was drawn by hand, the first where it is halfway."""
    out = np.zeros(shape, bool)
    for row, column, axis, share, point, _ in found:
        if point["kind"] & MARK:
            out[row + (axis and share > 0.5), column + (not axis and share > 0.5)] = True
    return out.astype(float)


def contours(found, depth):
    """(H, W, 2): the place of a contour on the way to the right, and down, of several the first that lies on the nearer
    surface; 0 for none."""
    out = np.zeros((*depth.shape, 2))
    for row, column, axis, share, point, z in found:
        near, far = sorted((depth[row, column], depth[row + axis, column + 1 - axis]))
        own = near * 0.97 <= z and (z <= near * 1.03 or z < (near + far) / 2)
        if point["kind"] & BOUNDS and own and not out[row, column, axis]:
            out[row, column, axis] = share
    return out
