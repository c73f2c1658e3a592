"""The open benchmark suite for language-conditioned reward learning in MuJoCo houses."""

__version__ = "0.2.0"
