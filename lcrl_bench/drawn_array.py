"""`DrawnArray`: a numpy array with a figure. Apart from `Drawn`, which is light to import."""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from lcrl_bench.drawn import Drawn


class DrawnArray(Drawn, np.ndarray):
    """A numpy array with a figure.

    Only the whole array has one: slices and results of arithmetic are plain numbers.
    """

    subject: Any
    """What the array describes; None for slices and results of arithmetic."""

    def __new__(cls, values: object, subject: object = None) -> Self:
        """View `values` as this type, without a copy if possible."""
        array = np.asarray(values).view(cls)
        array.subject = subject
        return array

    def __array_finalize__(self, origin: object) -> None:
        """Drop the subject: numpy calls this for every slice and result."""
        self.subject = None

    def _repr_html_(self) -> str | None:
        """The figure as HTML; None for a slice, so that its numbers are shown."""
        return None if self.subject is None else super()._repr_html_()
