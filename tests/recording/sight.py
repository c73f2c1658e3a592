"""Colours as people see them: with and without red and green cones, and printed in grey."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Linear RGB as a person without red or green cones sees it.
# Source: Machado, Oliveira and Fernandes (2009), table 1, severity 1.
DEUTERANOPIA = np.array([[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]])
PROTANOPIA = np.array([[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]])
FULL = np.eye(3)
SIGHTS = {"all cones": FULL, "no green": DEUTERANOPIA, "no red": PROTANOPIA}

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
_WHITE = _TO_XYZ.sum(axis=1)


def linear(colors: NDArray) -> NDArray[np.float64]:
    """SRGB 0..255 to linear light 0..1."""
    shares = np.asarray(colors, np.float64) / 255
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)


def luminance(colors: NDArray) -> NDArray[np.float64]:
    """How much light there is: 0 for black, 1 for white."""
    return linear(colors) @ _LUMINANCE


def contrast(first: NDArray, second: NDArray) -> float:
    """Contrast of two colours, 1..21. Source: WCAG 2.1, "contrast ratio"."""
    dark, light = sorted((float(luminance(first)), float(luminance(second))))
    return (light + 0.05) / (dark + 0.05)


def distance(first: NDArray, second: NDArray, sight: NDArray) -> float:
    """How different two colours look: CIE 1976, where about 2 can just be told apart."""
    return float(np.linalg.norm(_lab(first, sight) - _lab(second, sight)))


def _lab(color: NDArray, sight: NDArray) -> NDArray[np.float64]:
    seen = np.clip(linear(color) @ sight.T, 0, 1)
    shares = _TO_XYZ @ seen / _WHITE
    x, y, z = np.where(shares > 0.008856, np.cbrt(shares), 7.787 * shares + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])
