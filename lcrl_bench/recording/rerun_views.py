"""The four views of the panorama in a recording, with the names of what is in them."""

from __future__ import annotations

from typing import Final

import rerun as rr

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import HEADING_NAMES
from lcrl_bench.recording.palette import AGENT, WHITE
from lcrl_bench.recording.sightings import sightings

BELOW: Final = 2.7
"""Rows from a point to its name: the viewer writes it below."""


def log_classes(rec: rr.RecordingStream) -> None:
    """Log the name and the colour of every class, for all views and all times."""
    classes = [(entry.id, entry.words, entry.color) for entry in semantic_classes()]
    rec.log("views", rr.AnnotationContext(classes), static=True)


def log_views(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    """Log what is seen at a step where it is not what was seen before: pixels, names, the frame."""
    cell, heading = int(episode.cells[step]), int(episode.headings[step])
    moved = step == 0 or episode.panoramas[cell] != episode.panoramas[episode.cells[step - 1]]
    turned = step == 0 or heading != episode.headings[step - 1]
    for number, (name, view) in enumerate(zip(HEADING_NAMES, episode.panorama(cell), strict=True)):
        if moved:
            rec.log(f"views/{name}", rr.SegmentationImage(view))
            named = sightings(view)
            names = rr.Points2D(
                [(seen.column, seen.row - BELOW) for seen in named],
                labels=[seen.words for seen in named],
                colors=WHITE,
                radii=0.0,
                show_labels=True,
                draw_order=10,
            )
            rec.log(f"views/{name}/names", names)
        if turned:
            rows, columns = view.shape
            corners = [(0, 0), (columns, 0), (columns, rows), (0, rows), (0, 0)]
            frame = rr.LineStrips2D([corners], colors=AGENT, radii=0.4)
            facing = frame if number == heading else rr.Clear(recursive=False)
            rec.log(f"views/{name}/facing", facing)
