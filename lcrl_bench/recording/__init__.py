"""Everything people look at: Rerun recordings and plots."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.recording.episode import Episode as Episode
    from lcrl_bench.recording.episode import read_episode as read_episode
    from lcrl_bench.recording.episode import write_episode as write_episode
    from lcrl_bench.recording.figures import save_figure as save_figure
    from lcrl_bench.recording.pictures import house_picture as house_picture
    from lcrl_bench.recording.pictures import showcase_figure as showcase_figure
    from lcrl_bench.recording.reward_plan import reward_map_figure as reward_map_figure
    from lcrl_bench.recording.rollout import episode_of as episode_of
    from lcrl_bench.recording.run_recording import record_run as record_run
    from lcrl_bench.recording.storyboard import Storyboard as Storyboard
    from lcrl_bench.recording.storyboard import storyboard_of as storyboard_of
    from lcrl_bench.recording.views import panorama_picture as panorama_picture
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "Episode": ".episode",
            "read_episode": ".episode",
            "write_episode": ".episode",
            "save_figure": ".figures",
            "house_picture": ".pictures",
            "showcase_figure": ".pictures",
            "reward_map_figure": ".reward_plan",
            "episode_of": ".rollout",
            "record_run": ".run_recording",
            "Storyboard": ".storyboard",
            "storyboard_of": ".storyboard",
            "panorama_picture": ".views",
        },
    )
