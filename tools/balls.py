# SPDX-License-Identifier: GPL-3.0-or-later
"""Paints the balls that the stage *by example* comes with, the template over which artists paint their own, and a
tile for tones that are pictures.

    python tools/balls.py        writes addon/images/example_ball/, docs/example_template.png and docs/tones_tile.png

A ball is white plaster, lit from the top left. Its circle is three quarters of the picture wide, and the paint goes on
beyond it, because patches of it reach over the rim. All is painted at twice the size and shrunk.
"""

from pathlib import Path

import numpy as np

SIZE, FINE = 512, 1024
RADIUS = 0.375 * FINE
LIGHT = np.array((-0.5, 0.6, 0.6245))
ROOT = Path(__file__).parent.parent
_ROWS, _COLUMNS = np.mgrid[:FINE, :FINE]
ACROSS, UP = (_COLUMNS + 0.5 - FINE / 2) / RADIUS, (FINE / 2 - _ROWS - 0.5) / RADIUS


def lambert(x, y):
    """How far the ball faces the light at (x, y), in radii from its middle; beyond the rim as at the rim."""
    far = np.maximum(np.hypot(x, y), 1e-9)
    shrink = np.minimum(1, 1 / far)
    x, y = x * shrink, y * shrink
    return x * LIGHT[0] + y * LIGHT[1] + np.sqrt(np.maximum(1 - x * x - y * y, 0)) * LIGHT[2]


def ramp(value, stops):
    """Colours (..., 3) of values, between stops (value, #rrggbb)."""
    at, colors = zip(*stops, strict=True)
    table = np.array([[int(color[k:k + 2], 16) / 255 for k in (1, 3, 5)] for color in colors])
    return np.stack([np.interp(value, at, table[:, c]) for c in range(3)], -1)


def smooth(x):
    x = np.clip(x, 0, 1)
    return x * x * (3 - 2 * x)


def noise(rng, size, wave, stretch=1.0, angle=0.0):
    """Noise of mean 0 and variance 1 in a square, its waves `wave` pixels long and longer by `stretch` along an angle.
    """
    fx, fy = np.meshgrid(np.fft.fftfreq(size), np.fft.fftfreq(size))
    along, across = fx * np.cos(angle) - fy * np.sin(angle), fx * np.sin(angle) + fy * np.cos(angle)
    band = np.exp(-((along * stretch) ** 2 + across ** 2) * wave ** 2 * 2)
    out = np.fft.ifft2(np.fft.fft2(rng.standard_normal((size, size))) * band).real
    return (out - out.mean()) / out.std()


# ---- gouache ---------------------------------------------------------------------------------------------------------

GOUACHE = [(-0.8, "#2f2c55"), (-0.5, "#443d6b"), (-0.2, "#675a84"), (0.05, "#93799a"), (0.25, "#c29ea3"),
           (0.45, "#e3c6b4"), (0.65, "#f3e2cb"), (0.85, "#fbf3e2"), (1.0, "#fffdf6")]


def stroke(picture, rng, x, y, angle, length, width, color, load):
    """One pull of a flat brush, from (x, y) on: bristles lift as it runs dry."""
    bend = rng.normal(0, 0.12) * length
    reach = int(length + width) + 2
    x0, x1 = max(int(x) - reach, 0), min(int(x) + reach, FINE)
    y0, y1 = max(int(y) - reach, 0), min(int(y) + reach, FINE)
    if x1 <= x0 or y1 <= y0:
        return
    dx, dy = np.meshgrid(np.arange(x0, x1) + 0.5 - x, np.arange(y0, y1) + 0.5 - y)
    s = (dx * np.cos(angle) + dy * np.sin(angle)) / length
    u = (-dx * np.sin(angle) + dy * np.cos(angle) - bend * s * s) / (0.5 * width)
    hairs = max(int(width / 2.6), 5)
    hair = np.interp((u + 1.2) / 2.4 * hairs, np.arange(hairs + 1), rng.random(hairs + 1))
    end = 0.72 + 0.3 * np.interp((u + 1.2) / 2.4 * hairs, np.arange(hairs + 1), rng.random(hairs + 1))
    start = 0.05 * np.interp((u + 1.2) / 2.4 * hairs, np.arange(hairs + 1), rng.random(hairs + 1))
    dry = np.clip((s - load) / (1 - load), 0, 1) * 0.9
    cover = smooth((hair - dry) / 0.15 + 0.9) * smooth((end - s) / 0.05) * smooth((s - start) / 0.04)
    cover *= smooth((1 - np.abs(u)) * width * 0.35)
    ridge = (hair - 0.5) * 0.07 + 0.05 * smooth((np.abs(u) - 0.72) / 0.2)  # paint is pushed to the sides
    own = color + ridge[..., None] * (0.35 + 0.65 * color)
    patch = picture[y0:y1, x0:x1]
    patch += (own - patch) * (0.94 * cover)[..., None]


def gouache():
    rng = np.random.default_rng(7)
    picture = ramp(lambert(ACROSS, UP) * 0.9, GOUACHE)
    for width, count, jitter in ((90, 260, 0.08), (62, 420, 0.10), (40, 520, 0.11), (24, 260, 0.12)):
        for _ in range(count):
            # not evenly: the small ones where light turns to shade
            while True:
                px, py = rng.uniform(-1.36, 1.36, 2)
                value = lambert(px, py)
                if width > 40 or rng.random() < 0.25 + 0.75 * np.exp(-((value - 0.15) / 0.45) ** 2):
                    break
            step = 1e-3
            gx = lambert(px + step, py) - lambert(px - step, py)
            gy = lambert(px, py + step) - lambert(px, py - step)
            angle = np.arctan2(gx, gy) + rng.normal(0, 0.3)  # across the light, around the form; rows run down
            angle += np.pi * (rng.random() < 0.5)
            tone = np.clip(value + rng.normal(0, jitter), -0.8, 1)
            tone = np.round(tone * 7) / 7  # mixed beforehand
            color = ramp(tone, GOUACHE) + rng.normal(0, 0.014, 3)
            if value < -0.25 and px - py > 0.7 and rng.random() < 0.35:  # light from the ground
                color = 0.6 * color + 0.4 * np.array((0.52, 0.42, 0.52))
            length = width * rng.uniform(2.2, 4.2)
            x = FINE / 2 + RADIUS * px - 0.4 * length * np.cos(angle)
            y = FINE / 2 - RADIUS * py - 0.4 * length * np.sin(angle)
            stroke(picture, rng, x, y, angle, length, width * rng.uniform(0.75, 1.2), color, rng.uniform(0.25, 0.8))
    return picture * (1 + 0.012 * noise(rng, FINE, 2.2))[..., None]


# ---- wash ------------------------------------------------------------------------------------------------------------

PIGMENTS = np.array([[1.15, 0.82, 0.42], [0.62, 0.78, 0.95]])  # what each takes of red, green and blue: blue and brown


def wash():
    rng = np.random.default_rng(11)
    value = lambert(ACROSS, UP)
    tooth = 0.65 * noise(rng, FINE, 3.2) + 0.35 * noise(rng, FINE, 7)
    warm = noise(rng, FINE, 120)
    dense = np.zeros((2, FINE, FINE))
    for k, (edge, amount) in enumerate(((0.80, 0.16), (0.55, 0.22), (0.28, 0.34), (0.02, 0.42), (-0.28, 0.46),
                                        (-0.52, 0.4))):
        ragged = 0.075 * noise(rng, FINE, 60) + 0.03 * noise(rng, FINE, 16) + 0.012 * noise(rng, FINE, 5)
        inside = edge - value + ragged
        dry = smooth((noise(rng, FINE, 9, 5, 0.8) * 0.5 + tooth * 0.9 + 1.3 + inside * 9) / 0.5)
        wet = smooth(inside / 0.03) if k % 2 else smooth(inside / 0.16)
        pool = np.exp(-(np.maximum(inside, 0) / 0.028) ** 2) * (0.75 if k % 2 else 0.15)
        bloom = 1 + 0.22 * noise(rng, FINE, 45) + 0.13 * tooth + pool
        share = np.clip(0.68 + 0.1 * warm - 0.12 * k / 5, 0.2, 1)
        layer = amount * wet * bloom * (dry if k in (0, 2) else 1)
        dense += layer * np.stack([share, 1 - share])
    light = np.exp(-np.tensordot(np.maximum(dense, 0), PIGMENTS, (0, 0)))
    paper = np.array((0.995, 0.985, 0.96)) * (1 + 0.006 * tooth)[..., None]
    return (paper ** 2.2 * light) ** (1 / 2.2)


# ---- template --------------------------------------------------------------------------------------------------------

def template():
    """The ball in plain light, its circle, and marks in the corners to say which way up."""
    rng = np.random.default_rng(3)
    grey = 0.25 + 0.72 * smooth(0.5 + 0.5 * lambert(ACROSS, UP))
    far = np.hypot(ACROSS, UP)
    grey = np.where(far < 1, grey, 0.5 * grey + 0.45)
    grey *= 1 - 0.7 * smooth(1.6 - np.abs(far - 1) * RADIUS / 1.6)
    for value in (-0.4, 0.0, 0.4, 0.8):  # lines of equal light
        slope = np.hypot(*np.gradient(lambert(ACROSS, UP)))
        grey *= 1 - 0.25 * (far < 1) * smooth(1.5 - np.abs(lambert(ACROSS, UP) - value) / np.maximum(slope, 1e-6) / 1.5)
    return (grey * (1 + 0.004 * noise(rng, FINE, 1.5)))[..., None] * np.ones(3)


# ---- tile ------------------------------------------------------------------------------------------------------------

def tile():
    """Cuts of a knife in wood, side by side without a seam: where they are widest they are dark."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[:FINE, :FINE] / FINE
    bent = 0.35 * noise(rng, FINE, 130) + 0.1 * noise(rng, FINE, 40)
    cuts = np.cos(2 * np.pi * (14 * x + 20 * y) + bent * 2.2)
    broken = noise(rng, FINE, 26, 4, -0.96) * 0.55 + noise(rng, FINE, 3, 5, -0.96) * 0.18
    grey = 0.5 + 0.3 * (cuts + broken * (0.35 + 0.65 * np.abs(cuts)))
    return np.clip(grey, 0, 1)[..., None] * np.ones(3)


def write(path, picture):
    """The picture at half its size, sRGB."""
    from encre.cli import images

    small = np.clip(picture, 0, 1) ** 2.2
    small = small.reshape(SIZE, 2, SIZE, 2, 3).mean((1, 3)) ** (1 / 2.2)
    path.parent.mkdir(parents=True, exist_ok=True)
    images.write(str(path), images.openimageio().ImageSpec(SIZE, SIZE, 3, "uint8"),
                 np.round(255 * np.clip(small, 0, 1)).astype(np.uint8))


if __name__ == "__main__":
    for name, paint in (("gouache", gouache), ("wash", wash)):
        write(ROOT / "addon/images/example_ball" / f"{name}.png", paint())
    write(ROOT / "docs/example_template.png", template())
    write(ROOT / "docs/tones_tile.png", tile())
