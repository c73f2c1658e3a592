"""`Drawn`: objects with a figure, from `plot()` or by themselves in a notebook.

The drawing function is named, not imported, so these objects don't depend on plotting.
"""

from __future__ import annotations

from base64 import b64encode
from io import BytesIO
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from lcrl_bench.registry import import_target

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS_PER_INCH = 100
"""Resolution of figures in notebooks."""


class Drawn:
    """An object with a figure."""

    drawing: ClassVar[str]
    """The function that draws it, `"package.module:function"`; imported on first use."""

    def plot(self) -> Figure:
        """A matplotlib figure of it; `figure.savefig("figure.png")` saves it."""
        return import_target(self.drawing)(self)

    def _repr_html_(self) -> str:
        """The figure as HTML, for notebooks."""
        buffer = BytesIO()
        self.plot().savefig(buffer, format="png", dpi=DOTS_PER_INCH)
        data = b64encode(buffer.getvalue()).decode("ascii")
        return f'<img alt="{type(self).__name__}" src="data:image/png;base64,{data}">'


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
