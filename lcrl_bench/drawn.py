"""`Drawn`: what draws itself, by `plot()` and in a notebook.

The drawing is named, not imported: what is drawn knows nothing of figures.
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
"""Of a figure in a notebook."""


class Drawn:
    """Draws itself."""

    drawing: ClassVar[str]
    """What makes its figure: `"package.module:function"`, imported when it is first drawn."""

    def plot(self) -> Figure:
        """Draw it: a matplotlib figure; `figure.savefig("figure.png")` writes it."""
        return import_target(self.drawing)(self)

    def _repr_html_(self) -> str:
        """The figure as HTML, for notebooks."""
        buffer = BytesIO()
        self.plot().savefig(buffer, format="png", dpi=DOTS_PER_INCH)
        data = b64encode(buffer.getvalue()).decode("ascii")
        return f'<img alt="{type(self).__name__}" src="data:image/png;base64,{data}">'


class DrawnArray(Drawn, np.ndarray):
    """A numpy array that draws itself.

    It draws as long as it has the shape that it was made with: parts of it are numbers only.
    """

    subject: Any
    """What the array is about; None for parts of it and what is computed from it."""

    def __new__(cls, values: object, subject: object = None) -> Self:
        """Take the values, without copying where they need not be."""
        array = np.asarray(values).view(cls)
        array.subject = subject
        return array

    def __array_finalize__(self, origin: object) -> None:
        """Called by numpy for every part and result: these are not the whole any more."""
        self.subject = None

    def _repr_html_(self) -> str | None:
        """The figure as HTML; None, so that the numbers are shown, for a part."""
        return None if self.subject is None else super()._repr_html_()
