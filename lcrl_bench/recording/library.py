"""The recordings that a file or a folder stands for, by name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from lcrl_bench.errors import InvalidFileError, UnknownNameError
from lcrl_bench.evaluation.finished_runs import find_run
from lcrl_bench.evaluation.model_identity import MODEL_FILE, check_model
from lcrl_bench.recording.index import EPISODES, RECORDING_FILE, RecordedEpisode, read_index
from lcrl_bench.recording.rerun_viewer import check_recording


@dataclass(frozen=True)
class Recordings:
    """What there is to open."""

    main: Path
    """What is opened if nothing is said."""
    episodes: tuple[RecordedEpisode, ...]
    """All recorded episodes of a run, by task; none of a file."""

    def episode(self, name: str) -> Path:
        """The recording of an episode.

        Args:
            name: Of its task; or a part of it that no other has.

        Raises:
            UnknownNameError: If no episode, or more than one, is called so.
        """
        alike = [each for each in self.episodes if name in each.task]
        found = [each for each in alike if each.task == name] or alike
        if len(found) != 1:
            raise UnknownNameError("episode", name, [each.task for each in found or self.episodes])
        return self.file_of(found[0])

    def file_of(self, episode: RecordedEpisode) -> Path:
        """Its own recording, or the run's, which it is part of."""
        own = episode.files.get("recording")
        return self.main if own is None else self.main.parent / EPISODES / own.path


def find_recordings(target: Path) -> Recordings:
    """What a path stands for.

    Args:
        target: A .rrd file; a run's folder, or one above it, which stands for the run that was
            finished last; or a folder with one recording, as `ask` writes it.

    Raises:
        InvalidFileError: If it is no recording, or the run has none or another model by now.
        UsageError: If there is no such folder.
        NothingSelectedError: If no finished run is below the folder.
    """
    if target.suffix == ".rrd" or target.is_file():
        return Recordings(check_recording(target), ())
    loose = sorted(target.glob("*.rrd"))
    if len(loose) == 1 and loose[0].name != RECORDING_FILE:
        return Recordings(check_recording(loose[0]), ())
    run = find_run(target)
    if not (run / RECORDING_FILE).is_file():
        fix = "Repeat the command it was made by with --record showcase: it is not trained again."
        raise InvalidFileError(run, "this run has no recording", fix=fix)
    # What is shown was recorded of the model that is there; older runs don't say which it is.
    if (run / MODEL_FILE).exists():
        check_model(run)
    return Recordings(check_recording(run / RECORDING_FILE), read_index(run / EPISODES).episodes)
