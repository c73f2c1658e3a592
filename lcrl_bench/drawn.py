"""`Drawn`: objects with a figure, from `plot()` or by themselves in a notebook.

The drawing function is named, not imported, so these objects don't depend on plotting.
"""

from __future__ import annotations

from base64 import b64encode
from io import BytesIO
from typing import TYPE_CHECKING, ClassVar

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
