#!/usr/bin/python3
"""Draw the textures of the office: one picture per object, and tiles for floor, walls and furniture.

Every object has its own generator, so that adding one leaves the others as they are. Sizes are powers of two.
"""
import argparse
import pathlib
import zlib

import cv2
import numpy as np

FONTS = [
    cv2.FONT_HERSHEY_SIMPLEX,
    cv2.FONT_HERSHEY_TRIPLEX,
    cv2.FONT_HERSHEY_COMPLEX,
    cv2.FONT_HERSHEY_DUPLEX,
]


def generator(name: str) -> np.random.Generator:
    return np.random.default_rng(zlib.crc32(name.encode()))


def color(rng: np.random.Generator) -> tuple:
    return tuple(int(v) for v in rng.integers(0, 256, 3))


def text(image, words, box, font, ink, thickness=3) -> None:
    """Write `words` as large as they fit in box = (x, y, width, height)."""
    x, y, width, height = box
    (w, h), _ = cv2.getTextSize(words, font, 1.0, thickness)
    scale = min(width / w, height / h)
    cv2.putText(image, words, (x, y + int(h * scale)), font, scale, ink, thickness, cv2.LINE_AA)


def scribble(image, rng, area, style, count) -> None:
    """Fill area = (x, y, width, height) with shapes of random colours: what local features live on."""
    x, y, width, height = area
    for _ in range(count):
        points = (rng.random((4, 2)) * [width, height] + [x, y]).astype(np.int32)
        ink = color(rng)
        center = tuple(int(v) for v in points[0])
        if style == "triangles":
            cv2.fillPoly(image, [points[:3]], ink, cv2.LINE_AA)
            cv2.polylines(image, [points[:3]], True, (20, 20, 20), 2, cv2.LINE_AA)
        elif style == "circles":
            radius = int(rng.integers(8, 34))
            cv2.circle(image, center, radius, ink, -1, cv2.LINE_AA)
            cv2.circle(image, center, radius // 2, color(rng), 3, cv2.LINE_AA)
        elif style == "molecules":
            for other in points[1:]:
                cv2.line(image, center, tuple(int(v) for v in other), ink, 4, cv2.LINE_AA)
                cv2.circle(image, tuple(int(v) for v in other), 10, color(rng), -1, cv2.LINE_AA)
        elif style == "squares":
            size = int(rng.integers(24, 64))
            cv2.rectangle(image, center, (center[0] + size, center[1] + size // 2), ink, -1)


def book(name, cover, title, subtitle, style, font) -> np.ndarray:
    rng = generator(name)
    image = np.full((512, 512, 3), cover, np.uint8)
    cv2.rectangle(image, (18, 18), (494, 494), tuple(int(0.6 * v) for v in cover), 6)
    scribble(image, rng, (40, 210, 430, 220), style, 26)
    cv2.rectangle(image, (36, 36), (476, 190), (236, 242, 245), -1)
    text(image, title, (52, 52, 408, 66), font, (25, 25, 25), 4)
    text(image, subtitle, (52, 136, 408, 40), font, (60, 40, 120), 3)
    text(
        image, f"{int(rng.integers(2, 9))}th edition", (150, 452, 210, 26), font, (245, 245, 245), 2
    )
    return image


def printer(name, case, brand, ink, tray_y) -> np.ndarray:
    rng = generator(name)
    image = np.full((256, 512, 3), case, np.uint8)
    cv2.rectangle(image, (40, tray_y), (472, tray_y + 46), (28, 28, 28), -1)
    cv2.rectangle(image, (70, tray_y + 18), (442, tray_y + 44), (250, 250, 250), -1)
    side = int(rng.integers(0, 2)) * 300
    cv2.rectangle(image, (30 + side, 18), (160 + side, 74), (110, 90, 20), -1)
    text(image, "READY", (40 + side, 30, 110, 30), FONTS[0], (230, 250, 200), 2)
    for i in range(7):
        center = (200 - side // 2 + i * 40, 46 if i % 2 else 60)
        cv2.circle(image, center, 10, color(rng), -1, cv2.LINE_AA)
    for i in range(9):
        cv2.line(image, (478, 90 + 16 * i), (504, 90 + 16 * i), (90, 90, 90), 3)
    text(image, brand, (50, 196, 320, 40), FONTS[1], ink, 4)
    return image


def vessel(name, glaze, ink, words, style) -> np.ndarray:
    """Wrapped around a cylinder: the motif three times, so that every side shows it."""
    rng = generator(name)
    image = np.full((256, 1024, 3), glaze, np.uint8)
    tile = np.full((256, 256, 3), glaze, np.uint8)
    text(tile, words, (12, 50, 232, 62), FONTS[3], ink, 5)
    scribble(tile, rng, (10, 130, 215, 90), style, 9)
    for i in range(4):
        image[:, 256 * i : 256 * (i + 1)] = tile
    cv2.rectangle(image, (0, 0), (1023, 24), ink, -1)
    cv2.rectangle(image, (0, 236), (1023, 255), ink, -1)
    return image


def wood(name, base, contrast) -> np.ndarray:
    rng = generator(name)
    y, x = np.mgrid[0:256, 0:256] * (2 * np.pi / 256)
    grain = np.sin(14 * y + 1.5 * np.sin(x) + 0.8 * np.sin(3 * x)) + 0.5 * np.sin(
        29 * y + np.sin(2 * x)
    )
    noise = cv2.GaussianBlur(rng.normal(0, 1, (256, 256)), (9, 1), 0)
    return np.array(base) + contrast * (grain + noise)[..., None] * np.array([0.8, 0.9, 1.0])


def speckle(name, base, contrast, blur, joints) -> np.ndarray:
    rng = generator(name)
    noise = cv2.GaussianBlur(rng.normal(0, contrast, (256, 256)), (blur, blur), 0)
    image = np.array(base) + noise[..., None]
    for i in range(joints):
        line = i * 256 // joints
        image[line : line + 2] -= 35
        image[:, line : line + 2] -= 35
    return image


def pictures() -> dict:
    return {
        "tb1": book("tb1", (50, 40, 175), "ARTIFICIAL", "INTELLIGENCE", "triangles", FONTS[1]),
        "tb2": book("tb2", (60, 130, 35), "ORGANIC", "CHEMISTRY", "molecules", FONTS[0]),
        "tb3": book("tb3", (160, 80, 25), "ALGEBRA", "linear maps", "circles", FONTS[2]),
        "printer1": printer("printer1", (208, 212, 214), "LASERJET", (30, 30, 160), 100),
        "printer2": printer("printer2", (92, 84, 80), "OfficePrint", (230, 230, 230), 128),
        "mug1": vessel("mug1", (240, 244, 246), (30, 50, 170), "COFFEE", "circles"),
        "mug2": vessel("mug2", (70, 190, 235), (120, 50, 20), "ROBOT", "squares"),
        "pot1": vessel("pot1", (150, 70, 130), (235, 235, 240), "SOUP 42", "triangles"),
        "oak": wood("oak", (95, 150, 195), 7),
        "walnut": wood("walnut", (50, 75, 110), 7),
        "birch": wood("birch", (165, 200, 220), 5),
        "steel": speckle("steel", (165, 160, 155), 5, 3, 0),
        "stone": speckle("stone", (135, 140, 140), 25, 3, 0),
        "floor": speckle("floor", (165, 168, 170), 18, 5, 2),
        "wall": speckle("wall", (205, 215, 220), 6, 5, 0),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "directory", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).parent
    )
    directory = parser.parse_args().directory
    for name, image in pictures().items():
        path = directory / f"{name}.png"
        pixels = np.clip(image, 0, 255).astype(np.uint8)
        if not cv2.imwrite(str(path), pixels, [cv2.IMWRITE_PNG_COMPRESSION, 9]):
            raise OSError(f"cannot write {path}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
