"""Episodes as Rerun recordings, and Rerun's viewer.

Only this package imports Rerun, and it is itself imported only to record an episode or to open a
recording.
"""
